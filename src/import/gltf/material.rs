//! What a material of glTF becomes here: metal and roughness as Cook-Torrance, glass as refraction.

use super::buffers::{Buffers, file_of};
use super::json::Json;
use crate::color::Rgb;
use crate::import::job::{Job, Names};
use crate::import::place::{ImportError, Place};
use crate::scene::model::Model;
use crate::scene::{ImageFile, Material, Paint, fields};

/// Surfaces smoother than this get mirror rays; rougher ones show highlights alone.
const SMOOTH: f64 = 0.3;
/// Share of a metal's colour that rough metal shows as diffuse light, in place of blurred reflections.
const METAL_DIFFUSE: f64 = 0.3;

/// Index of refraction that stands for a metal's Fresnel reflectance.
const METAL_INDEX: f64 = 10.0;

/// The extensions of materials that are read.
const READ: [&str; 4] = [
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
];

/// Numbers of a material, before they are mapped.
struct Given {
    base: [f64; 3],
    alpha: f64,
    metallic: f64,
    roughness: f64,
    emission: [f64; 3],
    transmission: f64,
    ior: f64,
    unlit: bool,
    image: Option<ImageFile>,
}

/// Reads all materials of a document, and one more for primitives without any.
pub(super) fn materials(
    job: &mut Job<'_>,
    buffers: &Buffers<'_>,
) -> Result<Vec<Material>, ImportError> {
    let mut names = Names::default();
    let mut materials = Vec::new();
    for material in buffers.root.list("materials")? {
        let given = given(job, buffers, &material)?;
        let name = names.take(material.name(), "material");
        materials.push(mapped(&given, name));
    }
    let plain = Given {
        base: [1.0; 3],
        alpha: 1.0,
        metallic: 0.0,
        roughness: 1.0,
        emission: [0.0; 3],
        transmission: 0.0,
        ior: 1.5,
        unlit: false,
        image: None,
    };
    materials.push(mapped(&plain, names.take("default", "material")));
    Ok(materials)
}

fn given(
    job: &mut Job<'_>,
    buffers: &Buffers<'_>,
    material: &Json<'_>,
) -> Result<Given, ImportError> {
    remarks(job, material)?;
    let rough = material.get("pbrMetallicRoughness");
    let of = |key: &str, default: f64| match &rough {
        Some(rough) => rough.number_or(key, default),
        None => Ok(default),
    };
    let base = match &rough {
        Some(rough) => rough.numbers::<4>("baseColorFactor")?,
        None => None,
    };
    let [r, g, b, a] = base.unwrap_or([1.0; 4]);
    let blended = material.get("alphaMode").map_or(Ok(""), |mode| mode.text())? == "BLEND";
    let strength = match material.extension("KHR_materials_emissive_strength") {
        Some(extension) => extension.number_or("emissiveStrength", 1.0)?,
        None => 1.0,
    };
    let transmission = match material.extension("KHR_materials_transmission") {
        Some(extension) => {
            texture_remark(job, &extension, "transmissionTexture");
            extension.number_or("transmissionFactor", 0.0)?
        }
        None => 0.0,
    };
    let ior = match material.extension("KHR_materials_ior") {
        Some(extension) => extension.number_or("ior", 1.5)?,
        None => 1.5,
    };
    let texture = rough.as_ref().and_then(|rough| rough.get("baseColorTexture"));
    let image = match texture {
        Some(texture) => image(job, buffers, &texture)?,
        None => None,
    };
    Ok(Given {
        base: [r, g, b],
        alpha: if blended { a } else { 1.0 },
        metallic: of("metallicFactor", 1.0)?,
        roughness: of("roughnessFactor", 1.0)?,
        emission: material.numbers("emissiveFactor")?.unwrap_or([0.0; 3]).map(|x| x * strength),
        transmission,
        ior,
        unlit: material.extension("KHR_materials_unlit").is_some(),
        image,
    })
}

/// Says what of a material is left out.
fn remarks(job: &mut Job<'_>, material: &Json<'_>) -> Result<(), ImportError> {
    for key in ["normalTexture", "occlusionTexture", "emissiveTexture"] {
        texture_remark(job, material, key);
    }
    if let Some(rough) = material.get("pbrMetallicRoughness") {
        texture_remark(job, &rough, "metallicRoughnessTexture");
    }
    if let Some(mode) = material.get("alphaMode")
        && mode.text()? == "MASK"
    {
        let text = "`alphaMode` MASK is left out: transparency is the same all over a material";
        job.note(mode.at(), text);
    }
    for extension in material.get("extensions").iter().flat_map(Json::keys) {
        if !READ.contains(&extension) {
            let text = format!("`{extension}` is left out: materials have no place for it");
            job.note(material.at(), text);
        }
    }
    Ok(())
}

fn texture_remark(job: &mut Job<'_>, holder: &Json<'_>, key: &str) {
    if let Some(texture) = holder.get(key) {
        let why = match key {
            "normalTexture" => "bumps are images of heights, not of normals",
            "occlusionTexture" => "light is traced",
            _ => "images colour surfaces and bumps alone",
        };
        job.note(texture.at(), format!("`{key}` is left out: {why}"));
    }
}

/// The image of a texture; `None`, with a remark, if it cannot be shown.
fn image(
    job: &mut Job<'_>,
    buffers: &Buffers<'_>,
    info: &Json<'_>,
) -> Result<Option<ImageFile>, ImportError> {
    if info.whole_or("texCoord", 0)? != 0 {
        job.note(info.at(), "`texCoord` is left out: a mesh has one set of texture coordinates");
    }
    if info.extension("KHR_texture_transform").is_some() {
        job.note(
            info.at(),
            "`KHR_texture_transform` is left out: the image covers u and v from 0 to 1",
        );
    }
    let texture = info.need("index")?.follow(&buffers.root, "textures")?;
    if let Some(sampler) = texture.get("sampler") {
        let sampler = sampler.follow(&buffers.root, "samplers")?;
        for wrap in ["wrapS", "wrapT"] {
            if sampler.whole_or(wrap, 10_497)? != 10_497 {
                job.note(sampler.at(), format!("`{wrap}` is left out: images are repeated"));
            }
        }
    }
    let Some(source) = texture.get("source") else {
        job.note(texture.at(), "the texture is left out: its image is in no format that is read");
        return Ok(None);
    };
    let image = source.follow(&buffers.root, "images")?;
    if let Some(view) = image.get("bufferView") {
        let view = view.follow(&buffers.root, "bufferViews")?;
        let (bytes, _) = buffers.view(&view)?;
        return Ok(inside(job, &image, bytes));
    }
    let uri = image.need("uri")?;
    if uri.text()?.starts_with("data:") {
        let bytes = super::buffers::uri_bytes(job, &uri)?;
        return Ok(inside(job, &image, &bytes));
    }
    let name = file_of(uri.text()?).map_err(|cause| uri.error(cause))?;
    let place = Place::new(job.source, uri.at());
    Ok(job.image(&name, place))
}

fn inside(job: &mut Job<'_>, image: &Json<'_>, bytes: &[u8]) -> Option<ImageFile> {
    let name = if image.name().is_empty() { "image" } else { image.name() };
    job.image_inside(name, bytes, image.at())
}

/// Metal reflects in its colour and shows no diffuse light of its own; what is no metal reflects as
/// its index says; transmission refracts, tinted at every surface.
fn mapped(given: &Given, name: String) -> Material {
    let clamp = |x: f64| x.clamp(0.0, 1.0);
    let (metal, rough) = (clamp(given.metallic), clamp(given.roughness));
    let base = Rgb(given.base.map(|x| fields::COEFFICIENT.clamp(x) as f32));
    let (mirror, through) = (rough < SMOOTH, clamp(given.transmission) * (1.0 - metal));
    let mut m = Material { name, ambient: Rgb::BLACK, ..Material::new("") };
    m.paint = match &given.image {
        Some(image) => Paint::Image { image: image.clone(), tint: base, size: 1.0 },
        None => Paint::Solid(base),
    };
    m.emission = Rgb(given.emission.map(|x| fields::COEFFICIENT.clamp(x) as f32));
    m.ior = if given.ior == 0.0 { 1.5 } else { given.ior.clamp(0.1, 10.0) };
    if given.unlit {
        (m.ambient, m.diffuse) = (Rgb::WHITE, Rgb::BLACK);
        return m;
    }
    // F at normal incidence.
    let facing = ((m.ior - 1.0) / (m.ior + 1.0)).powi(2);
    let slope = rough * rough;
    m.model = Model::CookTorrance;
    m.roughness = fields::ROUGHNESS.clamp(slope) as f32;
    m.metallic = metal as f32;
    m.specular = Rgb::WHITE;
    if metal >= 0.5 {
        // The highlight's F comes from the index: 0.67 facing the light, as bright as metals are.
        m.ior = METAL_INDEX;
    }
    let share = |metal_share: f64| (1.0 - metal) + metal * metal_share;
    m.diffuse =
        Rgb::grey((share(if mirror { 0.0 } else { METAL_DIFFUSE }) * (1.0 - facing)) as f32);
    m.kloc = Rgb::grey(((1.0 - through) * clamp(given.alpha)) as f32);
    if mirror {
        // n of the lobe cosⁿ whose width is that of the slope: 2/m² − 2.
        let lobe = if slope < 0.01 { 0.0 } else { (2.0 / (slope * slope) - 2.0).min(1e6) };
        m.gloss = lobe as f32;
        m.translucency = if through > 0.0 { lobe as f32 } else { 0.0 };
        let plain = Rgb::grey(((1.0 - metal) * facing) as f32);
        m.reflect = plain + base.map(|x| x.min(1.0)) * metal as f32;
    }
    if through > 0.0 {
        m.transmit = Rgb::grey(through as f32);
        m.filter = base;
        m.fresnel = true;
        m.reflect = Rgb::grey(through as f32);
    } else if given.alpha < 1.0 {
        // Seen through, and not refracted.
        m.transmit = Rgb::grey((1.0 - clamp(given.alpha)) as f32);
        m.reflect = m.reflect * clamp(given.alpha) as f32;
        m.ior = 1.0;
    }
    m
}
