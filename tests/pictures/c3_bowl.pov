// A bowl cut out of a ball by a ball and a half-space, with a mirror inside, and a slotted block. CC0.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#default { finish { ambient 0.1 diffuse 0.7 } }
background { rgb <0.08,0.16,0.30> }
camera { location <3.2,-5,3> sky z up y right -x*image_width/image_height
  angle degrees(2*atan(tan(radians(45)/2)*image_width/image_height)) look_at <0,0,0> }
light_source { <-4,-5,6> rgb <1,1,1> }
plane { z, -1.5 pigment { checker rgb <0.9,0.9,0.2> rgb <0.8,0.1,0.1> } }
difference { sphere { <-1,0,0>, 1.3 pigment { rgb <0.2,0.4,0.9> } } sphere { <-1,0,0.1>, 1.1 pigment { rgb 0.1 } finish { ambient 0.1 diffuse 0.1 reflection { 0.9 } } }
  plane { <-0.36,0.48,-0.8>, -0.35 pigment { rgb <0.9,0.8,0.2> } } }
difference { box { <0.8,-1,-1.5>, <2.2,1,0.5> pigment { rgb 0.7 } } box { <1.2,-1.1,-0.3>, <1.8,1.1,0.6> pigment { rgb <0.9,0.2,0.1> } }
  box { <0.7,-0.3,-0.8>, <2.3,0.3,0.6> pigment { rgb <0.1,0.6,0.2> } } }
