//! Rayforest traces a scene once, keeps every pixel's ray tree, and from then on re-evaluates only
//! the shading.
//!
//! # The one idea
//!
//! The colour of a ray tree is a sum of products of *geometry* (cosines, visibilities), fixed once
//! traced, and *parameters* (colours, coefficients, lights), which people edit. Collect, per pixel,
//! everything with the same product of parameters, and the picture is a sparse matrix, the
//! [`Transport`](fold::transport::Transport), times a list of products, the *terms*. An edit
//! evaluates the terms and multiplies.
//!
//! # The road of the data
//!
//! Each arrow is one function that takes `&` of its left and gives its right; nothing flows back.
//!
//! ```text
//! scene text → Scene → Geometry → grow → Forest → fold → Transport → shade → Film → develop → file
//! ```
//!
//! # What always holds
//!
//! * **Live equals fresh.** After any history of edits the picture is, bit for bit, the one that a
//!   new process traces from the same scene. Tests hold it with random histories.
//! * **One rule of liveness**, [`follow`](scene::factor::FactorValues::follow): growing stops by it,
//!   and shading gives the value 0 by it to a stored branch that would not grow today. Where growth
//!   stopped, the trees keep a *frontier* record, and the terms a frontier mark; an edit that makes a
//!   frontier live is the only edit of a colour or coefficient that costs rays, but for trees that were
//!   released and an index of refraction that begins to matter. Fresnel's weights are geometry: a
//!   branch that they leave too faint is no parameter's to wake.
//! * **Kept trees answer rays.** A kept tree holds what rays met, a primitive and a distance per node,
//!   a solid per shadow crossing, and nothing that depends on parameters. Growing reads it: a ray that
//!   it knows is not cast, and everything else, normals, media, cosines, is computed again by the one
//!   code that a first trace runs. Where surfaces coincide, or one inside a solid of higher priority is
//!   passed, a node says so, and its ray's crossings are looked at once more. An edit that shading cannot follow is a
//!   [`Plan`](session::plan::Plan): the pixels concerned, found in the matrix and the frontier; only
//!   their blocks are grown and folded again, and put into the matrix when all are done. Where an edit
//!   wakes branches or moves lights, it names a [`Scope`](forest::scope::Scope), the terms that get
//!   other coefficients: nothing else of the trees is read, and all other rows stay.
//! * **Solids made of others** are one entry of the hierarchy. Their leaves are primitives with numbers
//!   of their own, which belong to the operand's solid: trees, materials and textures know nothing of
//!   operations. A whole line's crossings are merged, those that f64 cannot tell apart at once, so that
//!   the laws of the algebra hold to the bit. For what is refracted the whole is one medium, that of the
//!   operand by which it was entered.
//! * **Samples** depend on the pixel, their index, the effect and the branch alone. Where sampling is
//!   adaptive, a [`SampleMap`](forest::counts::SampleMap) follows from what every pixel's first samples
//!   saw: a function of the scene. A sample of a pixel that has few weighs more; that is all that folding
//!   knows of it. Where an edit lets first samples see something else, those of the pixels concerned are
//!   read again from the kept trees, and they and their neighbours are decided and grown again.
//! * **Keys.** A light that is moved gets a new key, so that records of where it was answer for
//!   nothing; one that is removed leaves a gap in the list of factors, which is black. Materials are
//!   not in the trees at all.
//! * **Order.** Terms are numbered by their factors along the path, never by discovery; a pixel is
//!   summed from +0 in that order, its planes first, then its single coefficients; vector lanes run
//!   across pixels. Thread count, tile order, released memory and edits therefore change no bit.
//! * **A pixel can be taken apart.** A term's share is what shading's running sum grows by as the term is
//!   added, so that shares add up to the picture's bits, rounding included; every sample's part of it
//!   follows from that sample folded alone, by the one folder. Nothing of shading is written twice.
//! * **Tiles stand alone.** A tile's light depends on the scene only: parts of a still, traced apart,
//!   merge bit for bit.
//! * **Bits.** No fused multiply-add, no power, logarithm or sine of the platform in what reaches a
//!   coefficient; no number that depends on a running counter.
//! * **Textures** give no coefficient of their own but shares of slots, which add up to 1, or a texel,
//!   which is one coefficient per channel: palette colours and tints are parameters like all others. They
//!   are functions of the point, or of u and v, and of how wide a pixel is there; none is kept in the
//!   trees. Bumps bend the shading normal alone: sides, and which lights are asked, follow the geometric
//!   one. A solid whose bump is another than in the kept trees sends its rays anew.
//! * **Geometry is f64** and holds no epsilon with a length in it. The f32 hierarchy only leaves out
//!   what cannot be hit.
//! * **The window waits for nobody.** A [`Live`](session::live::Live) session has a thread that owns
//!   the pictures and shades, one that traces, one that writes pictures; calls return at once, the
//!   newest wish wins, a lock is held only to move pointers. What is on the screen is a session,
//!   coarse or whole, so that it can be edited while the next one is traced; or the whole one while
//!   some of its pixels are grown again, all others being exact.
//! * **Two products.** The processor's is the picture: it is exported, compared and kept. A graphics card
//!   draws whole pictures besides, for the screen alone: its light may differ in the last bits, so that
//!   some pixels differ by a code value. Nothing waits for it, and a card that is lost takes nothing along.
//! * **Developing comes last.** Exposure, tone curve and sRGB are functions of a pixel's light alone; marks
//!   on what a screen cannot show are of the view, never of a file, and so is the region of the picture
//!   that is traced before the rest: it changes what is seen first, not what is seen in the end.
//! * **What is kept on disk** is a session's parts and the scene that they were made from; opening it is
//!   one edit, from that scene to the opened one. Nothing in the file is trusted: lengths, checksums
//!   and every index are checked first. The thread that shades writes it, in turns; the one that
//!   traces opens it.
//! * **Widgets write into a clone of the scene**; what differs is one step of the document's history
//!   and one wish to the session. The inspector visits the same list of fields as the reader and the
//!   writer of scene files: a parameter without a control cannot be written.
//! * **Examples** are texts in the program. One is opened as a copy without a file; what is traced of it goes
//!   to the cache folder, once, so that it opens without a ray from then on. Nothing in that folder is missed.
//! * **Files change on disk.** A thread looks at those of the document. What another program writes is a step
//!   of the history like any other; meshes and images are not in the history, which only names them.
//! * **The text belongs to the person.** A document keeps the text of its file and changes single
//!   values in it; whatever is written is read back and compared bit for bit first.
//! * **Looks** are differences by path. A [`Scene`](scene::Scene)'s values are those that show, with the
//!   look that is worn; what they are without it stands beside the looks, and is what its text says. So
//!   switching is an edit like any other, and nothing below the document knows of looks. A picture of
//!   another look than the one worn is an edit of the session and one back, where that needs no ray.
//! * **Nothing is dropped silently.** An import of another program's file is an ordinary scene, files
//!   beside it, and a list of remarks: what has no place in a scene, with its place in the file.
//! * **Absences.** `shade` never sees `geometry`; nothing below `cli` prints; nothing is `unsafe`;
//!   there are no globals.
//!
//! # The map
//!
//! The `mod` list below stands in the order of the floors, ground first: **a file names only modules
//! of floors below its own** (and its own module's files). A test reads this list and the paths in
//! every file and holds them to it.

// ground
pub mod clock;
pub mod color;
pub mod math;
pub mod progress;
// what the user wrote
pub mod scene;
// what the eye gets
pub mod film;
// scenes of other programs
pub mod import;
// ready for rays
pub mod geometry;
// volume and inertia
pub mod mass;
// ray trees
pub mod forest;
// trees to transport
pub mod fold;
// parameters and transport to light
pub mod shade;
// the program without a face
pub mod session;
// the work of a person: files, history, recovery
pub mod document;
// measurements
pub mod chart;
// faces
pub mod bench;
pub mod viewer;
// the command line opens the window
pub mod cli;
