// A room hollowed out of everything: the inverse of a box and a ball, met with a ball that is cut by inverses. CC0.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#default { finish { ambient 0.1 diffuse 0.7 } }
background { rgb <0.08,0.16,0.30> }
camera { location <3.2,-5,3> sky z up y right -x*image_width/image_height
  angle degrees(2*atan(tan(radians(45)/2)*image_width/image_height)) look_at <0,0,0> }
light_source { <-4,-5,6> rgb <1,1,1> }
intersection { box { <-6,-7,-1.5>, <6,4,8> inverse pigment { rgb <0.6,0.7,0.8> } } sphere { <-1.5,4,0>, 1.2 inverse pigment { rgb <0.9,0.3,0.2> } } }
intersection { sphere { 0, 1.2 pigment { rgb <0.2,0.6,0.3> } } sphere { <0.8,-0.8,0.8>, 0.9 inverse pigment { rgb <0.9,0.8,0.2> } }
  plane { <0.48,0.36,0.8>, 0.6 pigment { rgb 0.5 } } box { <-0.3,-2,-0.4>, <0.3,2,0.4> inverse pigment { rgb <0.3,0.2,0.8> } } }
