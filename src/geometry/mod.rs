//! The scene made ready for rays: primitives in world space, their hierarchy, and the two questions
//! asked of them, `closest_hit` and `occluded`.
