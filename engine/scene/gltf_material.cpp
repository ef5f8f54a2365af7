// Materials, textures and samplers. A picture gets one row for each way its colours are encoded.
#include <algorithm>
#include <cmath>

#include "scene/gltf_import.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

using nlohmann::json;

Wrap wrap_from(int value) {
  if (value == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::Clamp;
  if (value == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::Mirror;
  return Wrap::Repeat;
}

Sampler sampler_from(const tinygltf::Sampler& source) {
  Sampler sampler;
  sampler.u = wrap_from(source.wrapS);
  sampler.v = wrap_from(source.wrapT);
  if (source.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) sampler.mag = Filter::Nearest;
  switch (source.minFilter) {
    case TINYGLTF_TEXTURE_FILTER_NEAREST:
      sampler.min = sampler.mip = Filter::Nearest, sampler.mips = false;
      break;
    case TINYGLTF_TEXTURE_FILTER_LINEAR:
      sampler.mip = Filter::Nearest, sampler.mips = false;
      break;
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
      sampler.min = sampler.mip = Filter::Nearest;
      break;
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
      sampler.mip = Filter::Nearest;
      break;
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR:
      sampler.min = Filter::Nearest;
      break;
    default:
      break;  // trilinear is the default where the file leaves the choice
  }
  return sampler;
}

uint32_t picture_row(Importer& importer, size_t image, bool srgb) {
  const size_t origin = importer.source.images[image].same_as;
  const auto [entry, added] =
      importer.picture_rows.try_emplace({origin, srgb}, uint32_t(importer.scene.pictures.size()));
  if (added) {
    Picture picture;
    picture.name = describe("image", origin, importer.source.images[origin].name);
    picture.srgb = srgb;
    importer.scene.pictures.push_back(std::move(picture));
  }
  return entry->second;
}

uint32_t texture_row(Importer& importer, size_t index, bool srgb) {
  const tinygltf::Texture& source = importer.model.textures.at(index);
  if (source.source < 0) {
    refuse("textures[{}] has no picture, or one that only an unsupported extension describes", index);
  }
  Texture texture;
  texture.picture = picture_row(importer, size_t(source.source), srgb);
  if (source.sampler >= 0) texture.sampler = sampler_from(importer.model.samplers.at(size_t(source.sampler)));
  const Sampler& sampler = texture.sampler;
  const TextureKey key(texture.picture, sampler.mag, sampler.min, sampler.mip, sampler.mips, sampler.u, sampler.v);
  std::vector<Texture>& textures = importer.scene.textures;
  const auto [entry, added] = importer.texture_rows.try_emplace(key, uint32_t(textures.size()));
  if (added) textures.push_back(texture);
  return entry->second;
}

float unit(double value) {
  return std::clamp(float(value), 0.f, 1.f);
}

double number(const json& row, const char* name, double fallback) {
  return row.value(name, fallback);
}

template <int n>
glm::vec<n, float> vector(const json& row, const char* name, glm::vec<n, float> fallback) {
  if (!row.contains(name)) return fallback;
  for (int i = 0; i < n; ++i) fallback[i] = row[name][size_t(i)].get<float>();
  return fallback;
}

// KHR_texture_transform: offset, then rotation, then scale. The rotation's sign follows the extension's example ("the
// lower left quadrant, rotated clockwise"), which its GLSL, read by column, contradicts.
UvMapping mapping_from(Importer& importer, const json& info) {
  UvMapping mapping;
  int64_t set = info.value("texCoord", int64_t(0));
  if (const json* transform = extension_of(info, "KHR_texture_transform")) {
    set = transform->value("texCoord", set);
    const float angle = float(number(*transform, "rotation", 0)), c = std::cos(angle), s = std::sin(angle);
    const vec2 scale = vector<2>(*transform, "scale", vec2(1));
    mapping.offset = vector<2>(*transform, "offset", vec2(0));
    mapping.linear = glm::mat2(vec2(c, -s) * scale.x, vec2(s, c) * scale.y);
  }
  if (set > 1) importer.warn_once("textures on a UV set beyond TEXCOORD_1 use TEXCOORD_0 instead");
  mapping.set = set == 1 ? 1 : 0;
  return mapping;
}

AlphaMode alpha_from(const json& source, size_t row) {
  const std::string mode = source.value("alphaMode", "OPAQUE");
  if (mode == "MASK") return AlphaMode::Mask;
  if (mode == "BLEND") return AlphaMode::Blend;
  if (mode == "OPAQUE") return AlphaMode::Opaque;
  refuse("materials[{}].alphaMode is '{}'", row, one_line(mode, 40));
}

void read_textures(Importer& importer, const json& source, const json& pbr, Material& material) {
  const auto read = [&](const json& parent, const char* name, Slot slot, bool srgb, uint32_t& texture) {
    if (!parent.contains(name)) return;
    const json& info = parent[name];
    texture = texture_row(importer, info["index"].get<size_t>(), srgb);
    material.mapping[size_t(slot)] = mapping_from(importer, info);
  };
  read(pbr, "baseColorTexture", Slot::BaseColor, true, material.base_color_texture);
  read(pbr, "metallicRoughnessTexture", Slot::MetallicRoughness, false, material.metallic_roughness_texture);
  read(source, "normalTexture", Slot::Normal, false, material.normal_texture);
  read(source, "emissiveTexture", Slot::Emissive, true, material.emissive_texture);
  read(source, "occlusionTexture", Slot::Occlusion, false, material.occlusion_texture);
  if (material.normal_texture != none) material.normal_scale = float(number(source["normalTexture"], "scale", 1));
  if (material.occlusion_texture != none) {
    material.occlusion_strength = unit(number(source["occlusionTexture"], "strength", 1));
  }
  const json* specular = extension_of(source, "KHR_materials_specular");
  if (!specular) return;
  read(*specular, "specularTexture", Slot::Specular, false, material.specular_texture);
  read(*specular, "specularColorTexture", Slot::SpecularColor, true, material.specular_color_texture);
}

void read_extensions(const json& source, Material& material) {
  material.unlit = extension_of(source, "KHR_materials_unlit") != nullptr;
  if (const json* ior = extension_of(source, "KHR_materials_ior")) {
    // 0 is allowed and stands for a mirror: F0 = 1.
    material.ior = std::max(0.f, float(number(*ior, "ior", 1.5)));
  }
  if (const json* specular = extension_of(source, "KHR_materials_specular")) {
    material.specular = unit(number(*specular, "specularFactor", 1));
    material.specular_color = glm::max(vector<3>(*specular, "specularColorFactor", vec3(1)), vec3(0));
  }
  if (const json* strength = extension_of(source, "KHR_materials_emissive_strength")) {
    // Bounded so that the product stays a number.
    material.emissive = glm::min(material.emissive, vec3(1e15f)) *
                        std::clamp(float(number(*strength, "emissiveStrength", 1)), 0.f, 1e15f);
  }
}

Material material_from(Importer& importer, const json& source, size_t row) {
  static const json empty = json::object();
  const json& pbr = source.contains("pbrMetallicRoughness") ? source["pbrMetallicRoughness"] : empty;
  Material material;
  material.name = one_line(source.value("name", ""));
  material.base_color = glm::clamp(vector<4>(pbr, "baseColorFactor", vec4(1)), vec4(0), vec4(1));
  material.metallic = unit(number(pbr, "metallicFactor", 1));
  material.roughness = unit(number(pbr, "roughnessFactor", 1));
  material.emissive = glm::max(vector<3>(source, "emissiveFactor", vec3(0)), vec3(0));
  material.alpha_cutoff = std::max(0.f, float(number(source, "alphaCutoff", 0.5)));
  material.alpha = alpha_from(source, row);
  material.double_sided = source.value("doubleSided", false);
  read_textures(importer, source, pbr, material);
  read_extensions(source, material);
  return material;
}

}  // namespace

void import_materials(Importer& importer) {
  const json& document = importer.source.document;
  if (!document.contains("materials")) return;
  const json& materials = document["materials"];
  importer.budget.take(uint64_t(materials.size()) * sizeof(Material), "materials");
  for (size_t i = 0; i < materials.size(); ++i) {
    importer.scene.materials.push_back(material_from(importer, materials[i], i));
  }
  if (const json* extension = extension_of(document, "KHR_materials_variants"); extension && !materials.empty()) {
    if (!extension->contains("variants")) return;
    for (const json& variant : (*extension)["variants"]) {
      importer.scene.variants.push_back(one_line(variant.value("name", "")));
    }
  }
}

}  // namespace nf::scene::gltf
