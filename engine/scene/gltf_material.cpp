// Materials, textures and samplers. A picture gets one row for each way its colours are encoded.
#include <algorithm>

#include "core/log.h"
#include "scene/gltf_import.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

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

uint32_t texture_row(Importer& importer, int index, int tex_coord, bool srgb) {
  if (index < 0) return none;
  const tinygltf::Texture& source = importer.model.textures.at(size_t(index));
  if (source.source < 0) {
    refuse("textures[{}] has no picture, or one that only an unsupported extension describes", index);
  }
  if (tex_coord != 0) importer.warn_once("textures on a UV set other than TEXCOORD_0 use TEXCOORD_0 instead");
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

AlphaMode alpha_from(const tinygltf::Material& source, size_t row) {
  if (source.alphaMode == "MASK") return AlphaMode::Mask;
  if (source.alphaMode == "BLEND") return AlphaMode::Blend;
  if (source.alphaMode == "OPAQUE") return AlphaMode::Opaque;
  refuse("materials[{}].alphaMode is '{}'", row, one_line(source.alphaMode, 40));
}

float unit(double value) {
  return std::clamp(float(value), 0.f, 1.f);
}

float emissive_strength(const tinygltf::Material& source) {
  const auto extension = source.extensions.find("KHR_materials_emissive_strength");
  if (extension == source.extensions.end() || !extension->second.Has("emissiveStrength")) return 1;
  return std::max(0.f, float(extension->second.Get("emissiveStrength").GetNumberAsDouble()));
}

Material material_from(Importer& importer, const tinygltf::Material& source, size_t row) {
  Material material;
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  material.name = one_line(source.name);
  for (size_t i = 0; i < 4; ++i) material.base_color[int(i)] = unit(pbr.baseColorFactor.at(i));
  material.metallic = unit(pbr.metallicFactor);
  material.roughness = unit(pbr.roughnessFactor);
  const float strength = emissive_strength(source);
  for (size_t i = 0; i < 3; ++i) {
    // Bounded so that the product stays a number.
    const double radiance = std::max(0.0, source.emissiveFactor.at(i)) * strength;
    material.emissive[int(i)] = float(std::min(radiance, 1e30));
  }
  material.normal_scale = float(source.normalTexture.scale);
  material.alpha_cutoff = std::max(0.f, float(source.alphaCutoff));
  material.alpha = alpha_from(source, row);
  material.double_sided = source.doubleSided;
  const auto texture = [&](const auto& info, bool srgb) {
    return texture_row(importer, info.index, info.texCoord, srgb);
  };
  material.base_color_texture = texture(pbr.baseColorTexture, true);
  material.metallic_roughness_texture = texture(pbr.metallicRoughnessTexture, false);
  material.normal_texture = texture(source.normalTexture, false);
  material.emissive_texture = texture(source.emissiveTexture, true);
  return material;
}

}  // namespace

void import_materials(Importer& importer) {
  for (size_t i = 0; i < importer.model.materials.size(); ++i) {
    importer.scene.materials.push_back(material_from(importer, importer.model.materials[i], i));
  }
}

}  // namespace nf::scene::gltf
