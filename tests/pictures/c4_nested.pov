// Operations within operations, turned, moved and stretched: a die and a bracket. CC0.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#default { finish { ambient 0.1 diffuse 0.7 } }
background { rgb <0.08,0.16,0.30> }
camera { location <3.2,-5,3> sky z up y right -x*image_width/image_height
  angle degrees(2*atan(tan(radians(45)/2)*image_width/image_height)) look_at <0,0,0> }
light_source { <-4,-5,6> rgb <1,1,1> }
plane { z, -1.5 pigment { checker rgb <0.9,0.9,0.2> rgb <0.8,0.1,0.1> } }
#declare Pip = sphere { 0, 0.18 pigment { rgb 0.9 } }
#declare Pips = union { object { Pip translate <-0.4,-0.4,0> } object { Pip } object { Pip translate <0.4,0.4,0> } }
difference { intersection { box { -0.9, 0.9 } sphere { 0, 1.25 } pigment { rgb <0.7,0.1,0.1> } }
  object { Pips translate z*0.92 } object { Pips rotate x*90 translate y*-0.92 } object { Pip scale <1,1,1.5> rotate y*90 translate x*0.92 }
  rotate <0,0,20> translate <-1.2,-0.3,-0.4> }
difference { union { box { <-1,-0.5,0>, <1,0.5,0.2> } difference { box { <-1,-0.5,0>, <-0.8,0.5,1.6> } box { <-1.1,-0.25,0.7>, <-0.7,0.25,1.3> rotate x*15 } } pigment { rgb <0.5,0.6,0.7> } }
  union { sphere { <0.2,0,0.2>, 0.3 } sphere { <0.7,0,0.2>, 0.22 } pigment { rgb <0.9,0.8,0.2> } }
  rotate <10,0,-30> scale <1,1,0.9> translate <1.1,0.6,-1> }
