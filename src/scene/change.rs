//! What an edit touches, found by comparing two scenes field by field.
