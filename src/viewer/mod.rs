//! The window: a picture, its scene beside it, and every control with its cost.
