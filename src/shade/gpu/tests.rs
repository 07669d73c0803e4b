//! The shader's structs and constants are those of Rust.

use std::sync::Arc;

use wgpu::naga::front::wgsl::parse_str;
use wgpu::naga::proc::Layouter;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
use wgpu::naga::{Expression, Literal, Module, TypeInner};

use super::device::GROUP;
use super::parts::{Corner, Limits, Look, Record, parts, pieces};
use crate::film::FilmBlock;
use crate::film::clipping::{OVER, UNDER};
use crate::film::layout::{BLOCK, LANES, Layout, TILE, TILE_BLOCKS};
use crate::fold::transport::{BlockStart, Plane, Single, Transport, TransportTile};
use crate::scene::tone::Tone;

const SHADER: &str = include_str!("../shade.wgsl");

fn module(text: &str) -> Module {
    let module = parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(&module).expect("a shader that can be compiled");
    module
}

/// Names and places of a struct's members, and the distance between two of the struct in an array.
fn layout(module: &Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let named = |ty: &&wgpu::naga::Type| ty.name.as_deref() == Some(name);
    let mut types = module.types.iter().map(|(_, ty)| ty);
    let ty = types.find(named).unwrap_or_else(|| panic!("no struct {name}"));
    let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no struct") };
    let members = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
    (members.collect(), *span as usize)
}

/// What differs between a struct of the shader and that of Rust.
fn difference<R: Record>(module: &Module) -> Option<String> {
    let own = R::MEMBERS.iter().map(|&(name, at)| (name.to_owned(), at)).collect();
    let (shader, own) = (layout(module, R::NAME), (own, size_of::<R>()));
    (shader != own).then(|| format!("{}: {shader:?} in the shader, {own:?} here", R::NAME))
}

fn constant(module: &Module, name: &str) -> u32 {
    let found = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
    let (_, found) = found.unwrap_or_else(|| panic!("no constant {name}"));
    match module.global_expressions[found.init] {
        Expression::Literal(Literal::U32(value)) => value,
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn the_shader_has_the_structs_of_rust() {
    let module = module(SHADER);
    assert_eq!(difference::<Look>(&module), None);
    assert_eq!(difference::<Corner>(&module), None);
    assert_eq!(difference::<BlockStart>(&module), None);
    assert_eq!(difference::<Single>(&module), None);
    // These two are arrays of floats here.
    assert_eq!(layout(&module, "Plane"), (vec![("coefficients".into(), 0)], size_of::<Plane>()));
    assert_eq!(layout(&module, "FilmBlock"), (vec![("rows".into(), 0)], size_of::<FilmBlock>()));
}

#[test]
fn every_struct_in_a_buffer_was_compared() {
    let module = module(SHADER);
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).unwrap();
    let structs =
        module.types.iter().filter(|(_, ty)| matches!(ty.inner, TypeInner::Struct { .. }));
    let mut names: Vec<_> = structs.map(|(_, ty)| ty.name.clone().unwrap_or_default()).collect();
    names.sort();
    assert_eq!(names, ["BlockStart", "Corner", "FilmBlock", "Look", "Plane", "Single"]);
    for (_, variable) in module.global_variables.iter() {
        if let TypeInner::Array { base, stride, .. } = module.types[variable.ty].inner {
            let size = layouter[base].size;
            assert_eq!(stride, size, "{:?}: elements lie one after another", variable.name);
        }
    }
}

#[test]
fn a_struct_that_differs_is_found() {
    let swapped = SHADER.replacen(
        "place: u32,\n    coefficient: f32,",
        "coefficient: f32,\n    place: u32,",
        1,
    );
    let longer = SHADER.replacen("    y: u32,\n", "    y: u32,\n    z: u32,\n", 1);
    let renamed = SHADER.replace("gain", "factor");
    assert!([&swapped, &longer, &renamed].iter().all(|text| **text != SHADER));
    assert!(difference::<Single>(&module(&swapped)).is_some());
    assert!(difference::<Corner>(&module(&longer)).is_some());
    assert!(difference::<Look>(&module(&renamed)).is_some());
}

#[test]
fn the_shader_has_the_constants_of_rust() {
    let module = module(SHADER);
    for (name, value) in [
        ("TILE", TILE),
        ("BLOCK", BLOCK),
        ("LANES", LANES as u32),
        ("TILE_BLOCKS", TILE_BLOCKS as u32),
        ("GROUP", GROUP),
        ("NEUTRAL", Tone::Neutral as u32),
        ("OVER", OVER),
        ("UNDER", UNDER),
    ] {
        assert_eq!(constant(&module, name), value, "{name}");
    }
    let threads: Vec<_> =
        module.entry_points.iter().map(|e| (&*e.name, e.workgroup_size)).collect();
    assert_eq!(threads, [("film", [GROUP, 1, 1]), ("frame", [GROUP, 1, 1])]);
}

#[test]
fn a_record_writes_its_members_where_they_lie() {
    let mut bytes = Vec::new();
    Single::new(5, 9, 2.5).write(&mut bytes);
    assert_eq!(bytes, [0x59, 0, 0, 0, 0, 0, 0x20, 0x40]);
    bytes.clear();
    BlockStart { plane: 7, single: 258 }.write(&mut bytes);
    assert_eq!(bytes, [7, 0, 0, 0, 2, 1, 0, 0]);
    assert_eq!(std::mem::offset_of!(Single, coefficient), 4);
    assert_eq!(std::mem::offset_of!(BlockStart, single), 4);
}

/// A matrix of five tiles, the third of which has planes and the fourth singles.
fn transport() -> Transport {
    let tile = |planes: u32, singles: u32| {
        let mut starts = vec![BlockStart::default(); TILE_BLOCKS];
        starts.push(BlockStart { plane: planes, single: singles });
        let single = |entry| Single::new(entry, 3, 0.5);
        Arc::new(TransportTile {
            terms: (0..planes.max(singles)).map(|i| i * 2).collect(),
            starts,
            entries: (0..planes).collect(),
            planes: vec![Plane::default(); planes as usize],
            singles: (0..singles).map(single).collect(),
            ..TransportTile::default()
        })
    };
    let tiles = vec![tile(0, 0), tile(0, 0), tile(9, 0), tile(0, 7), tile(1, 1)];
    let layout = Layout::new([5 * TILE, 7]);
    Transport { layout, samples: 1, tiles, ..Transport::default() }
}

const LARGE: Limits = Limits { binding: 1 << 27, tiles: 65_535, texture_side: 8192 };

#[test]
fn a_tile_that_changes_is_uploaded_again_and_no_other() {
    let mut transport = transport();
    let cut = parts(&transport, &pieces(transport.layout.size, LARGE), LARGE);
    let [part] = &mut cut.unwrap()[..] else { panic!("one part") };
    assert_eq!(part.renew(&transport), []);
    // The same bytes elsewhere are another tile: whether they differ is not looked at.
    transport.tiles[3] = Arc::new(TransportTile::clone(&transport.tiles[3]));
    // What is changed where it lies is another one too, though nobody else has it.
    Arc::make_mut(&mut transport.tiles[2]).planes[4].0[5] = 1.0;
    Arc::make_mut(&mut transport.tiles[0]);
    assert_eq!(part.renew(&transport), [0..1, 2..4]);
    assert_eq!(part.renew(&transport), []);
    assert!(part.fits(&transport));
    Arc::make_mut(&mut transport.tiles[3]).singles.pop();
    assert!(!part.fits(&transport), "another length has no place");
}

#[test]
fn parts_hold_every_tile_once_and_keep_the_limits() {
    let transport = transport();
    let planes = |count: u64| Limits { binding: count * 64, ..LARGE };
    let cut = |limits: Limits| {
        let parts = parts(&transport, &pieces(transport.layout.size, limits), limits)?;
        Some(parts.iter().map(|part| part.tiles.clone()).collect::<Vec<_>>())
    };
    assert_eq!(cut(LARGE), Some(vec![vec![0, 1, 2, 3, 4]]));
    assert_eq!(cut(Limits { tiles: 2, ..LARGE }), Some(vec![vec![0, 1], vec![2, 3], vec![4]]));
    // The light of a tile, 12 288 bytes, is the largest here.
    assert_eq!(cut(planes(3 * 192)), Some(vec![vec![0, 1, 2], vec![3, 4]]));
    assert_eq!(cut(planes(191)), None);
    let side = Limits { texture_side: 95, ..LARGE };
    assert_eq!(cut(side), Some(vec![vec![0, 1], vec![2, 3], vec![4]]));
}
