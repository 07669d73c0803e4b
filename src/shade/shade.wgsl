// The matrix product on a graphics card: a pixel is a thread, and sums its own terms.
//
// Twin of cpu.rs, and of film/develop.rs and color.rs as far as they follow the product: the same
// functions, with the same statements in the same order. What differs: the terms are named by their
// index in the picture's list instead of that in the tile's dictionary, so that nothing is gathered
// first, and a card may fuse a multiplication with an addition.
//
// A test reads this file and holds its constants and structs to those of Rust.

// Side of a tile and of a block in pixels; pixels of a block, blocks of a tile.
const TILE: u32 = 32u;
const BLOCK: u32 = 4u;
const LANES: u32 = 16u;
const TILE_BLOCKS: u32 = 64u;
// Threads that run together: those of some blocks.
const GROUP: u32 = 64u;
// The tone curve that is not the identity.
const NEUTRAL: u32 = 1u;
// Marks on pixels brighter than white, and darker than black: 0xRRGGBB.
const OVER: u32 = 0xff0050u;
const UNDER: u32 = 0x0078ffu;

// What is shown of the light.
struct Look {
    gain: f32,
    // Index of the tone curve.
    tone: u32,
    // Whether clipped pixels are marked: 0 or 1.
    marks: u32,
}

// The first pixel of a tile, counted from the corner of the texture.
struct Corner {
    x: u32,
    y: u32,
}

struct BlockStart {
    plane: u32,
    single: u32,
}

struct Plane {
    coefficients: array<f32, LANES>,
}

// Term in bits 4…31 of the place, lane in bits 0…3.
struct Single {
    place: u32,
    coefficient: f32,
}

struct FilmBlock {
    rows: array<array<f32, LANES>, 3>,
}

@group(0) @binding(0) var<uniform> look: Look;
// Per term red, green, blue, and not 0 if any of them is not.
@group(0) @binding(1) var<storage, read> values: array<vec4<f32>>;
// Of the tiles of this part of the picture.
@group(0) @binding(2) var<storage, read> corners: array<Corner>;
// Per tile 65: the blocks' and the end.
@group(0) @binding(3) var<storage, read> starts: array<BlockStart>;
// The term of each plane.
@group(0) @binding(4) var<storage, read> entries: array<u32>;
@group(0) @binding(5) var<storage, read> planes: array<Plane>;
@group(0) @binding(6) var<storage, read> singles: array<Single>;

@group(1) @binding(0) var<storage, read_write> light: array<FilmBlock>;
@group(1) @binding(0) var shown: texture_storage_2d<rgba8unorm, write>;

// The linear picture of the part's tiles, 64 blocks for each.
@compute @workgroup_size(GROUP)
fn film(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let tile = group.y;
    let block = group.x * (GROUP / LANES) + thread / LANES;
    let lane = thread % LANES;
    let pixel = sum(tile, block, lane);
    let at = tile * TILE_BLOCKS + block;
    light[at].rows[0][lane] = pixel.r;
    light[at].rows[1][lane] = pixel.g;
    light[at].rows[2][lane] = pixel.b;
}

// The picture as shown: product, development and sRGB in one pass.
@compute @workgroup_size(GROUP)
fn frame(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let tile = group.y;
    let block = group.x * (GROUP / LANES) + thread / LANES;
    let lane = thread % LANES;
    let pixel = sum(tile, block, lane);
    let corner = vec2<u32>(corners[tile].x, corners[tile].y);
    let columns = TILE / BLOCK;
    let at = corner + BLOCK * vec2<u32>(block % columns, block / columns)
        + vec2<u32>(lane % BLOCK, lane / BLOCK);
    // Blocks may hang over the edge of the picture.
    if all(at < textureDimensions(shown)) {
        textureStore(shown, at, encode(pixel));
    }
}

// Σ coefficient · value for one pixel: the sum over the planes plus, where there are any, the sum
// over the single coefficients, each from +0 in canonical order.
fn sum(tile: u32, block: u32, lane: u32) -> vec3<f32> {
    let start = starts[tile * (TILE_BLOCKS + 1u) + block];
    let end = starts[tile * (TILE_BLOCKS + 1u) + block + 1u];
    var sum = vec3<f32>(0.0);
    for (var i = start.plane; i < end.plane; i++) {
        let value = values[entries[i]];
        if value.w == 0.0 {
            continue;
        }
        sum += planes[i].coefficients[lane] * value.rgb;
    }
    if start.single < end.single {
        sum += sum_singles(start.single, end.single, lane);
    }
    return sum;
}

// The terms of few pixels.
fn sum_singles(start: u32, end: u32, lane: u32) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    for (var i = start; i < end; i++) {
        let single = singles[i];
        if single.place % LANES == lane {
            sum += single.coefficient * values[single.place / LANES].rgb;
        }
    }
    return sum;
}

// A pixel as sRGB code values, a fraction of the greatest; or its mark, if it is clipped.
fn encode(light: vec3<f32>) -> vec4<f32> {
    let exposed = light * look.gain;
    var displayed = exposed;
    if look.tone == NEUTRAL {
        displayed = neutral(exposed);
    }
    if look.marks != 0u {
        let mark = mark_of(light, displayed);
        if mark != 0u {
            let color = vec3<u32>(mark >> 16u, mark >> 8u & 255u, mark & 255u);
            return vec4<f32>(vec3<f32>(color) / 255.0, 1.0);
        }
    }
    var code = vec3<f32>(0.0);
    for (var channel = 0u; channel < 3u; channel++) {
        code[channel] = round(srgb_code(displayed[channel])) / 255.0;
    }
    return vec4<f32>(code, 1.0);
}

// Twin of film/clipping.rs: the colour of the mark, 0 where there is none.
fn mark_of(light: vec3<f32>, displayed: vec3<f32>) -> u32 {
    if any(displayed >= vec3<f32>(1.0)) {
        return OVER;
    }
    return select(UNDER, 0u, all(light >= vec3<f32>(0.0)));
}

// Twin of film/tone.rs: Khronos PBR Neutral.
fn neutral(exposed: vec3<f32>) -> vec3<f32> {
    let sheen = 0.04;
    let start = 0.8 - sheen;
    let desaturation = 0.15;
    let most = 1e9;
    var color = select(vec3<f32>(0.0), exposed, exposed > vec3<f32>(0.0));
    color = select(vec3<f32>(most), color, color < vec3<f32>(most));
    let x = min(min(color.r, color.g), color.b);
    let offset = select(sheen, x - 6.25 * x * x, x < 2.0 * sheen);
    color -= offset;
    let p = max(max(color.r, color.g), color.b);
    if p < start {
        return color;
    }
    let d = 1.0 - start;
    let peak = 1.0 - d * d / (p + d - start);
    let scaled = color * (peak / p);
    let white = 1.0 - 1.0 / (desaturation * (p - peak) + 1.0);
    return scaled + (vec3<f32>(peak) - scaled) * white;
}

// The sRGB curve of IEC 61966-2-1, 0 … 255 as a fraction of a code value; input clamped to 0 … 1.
fn srgb_code(linear: f32) -> f32 {
    var x = select(0.0, linear, linear > 0.0);
    x = select(1.0, x, x < 1.0);
    let y = sqrt(sqrt(x));
    var q = -0.06814732;
    q = q * y + 0.28953302;
    q = q * y - 0.5774827;
    q = q * y + 1.2554044;
    q = q * y + 0.16202627;
    q = q * y - 0.061340217;
    var curve = select(q, x * 12.92, x <= 0.0031308);
    curve = select(1.0, curve, curve < 1.0);
    return curve * 255.0;
}
