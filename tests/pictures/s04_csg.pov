// ONE THING: CSG difference/intersection. (sphere AND box) MINUS three cylinders, the classic part. Matte. CC0.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#default { finish { ambient 0.1 diffuse 0.7 } }
background { rgb <0.08,0.16,0.30> }
camera { location <3.2,-5,3> sky z up y right -x*image_width/image_height
  angle degrees(2*atan(tan(radians(45)/2)*image_width/image_height)) look_at <0,0,0> }
light_source { <-4,-5,6> rgb <1,1,1> }
plane { z, -1 pigment { rgb 0.8 } }
difference { intersection { sphere { 0, 1.35 } box { -1, 1 } pigment { rgb <0.2,0.4,0.9> } }
  union { cylinder { -2*x, 2*x, 0.55 } cylinder { -2*y, 2*y, 0.55 } cylinder { -2*z, 2*z, 0.55 } pigment { rgb <0.9,0.8,0.2> } } }
