// A glass lens and a glass ball with a bite: intersection and difference of what refracts. CC0.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#default { finish { ambient 0.1 diffuse 0.7 } }
background { rgb <0.08,0.16,0.30> }
camera { location <3.2,-5,3> sky z up y right -x*image_width/image_height
  angle degrees(2*atan(tan(radians(45)/2)*image_width/image_height)) look_at <0,0,0> }
light_source { <-4,-5,6> rgb <1,1,1> }
plane { z, -1.5 pigment { checker rgb <0.9,0.9,0.2> rgb <0.8,0.1,0.1> } }
#declare GL = material { texture { pigment { rgbt <1,1,1,1> } finish { ambient 0 diffuse 0 } } interior { ior 1.5 } }
intersection { sphere { <0,-1.2,0>, 1.7 } sphere { <0,1.2,0>, 1.7 } rotate z*35 translate <-1.2,-0.3,0> material { GL } }
difference { sphere { 0, 1.1 } sphere { <0.7,-0.9,0.7>, 0.8 } translate <1.3,0.4,-0.3> material { GL } }
