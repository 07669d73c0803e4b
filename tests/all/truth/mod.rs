//! The picture against other ways to know it: a second evaluation, another renderer, closed forms,
//! and the same scene in other units.

mod evaluator;
mod fuzz;
mod golden;
mod image_scale;
mod lens;
mod physics;
mod picture;
mod povray;
mod preorder;
mod stage;
