//! The factors of every product of parameters: the only functions of parameters in a picture.
