// The structure of what a surface or a light is made of: materials, textures, pictures, cameras, lights; and of skins
// and animations.
#include "scene/gltf_check.h"

namespace nf::scene::gltf {

namespace {

// Takes a reference to a texture, with the section's rows.
void check_texture(const At& root, const At& info) {
  info.require("index");
  info.index("index", "textures", root.rows("textures"));
  info.integer("texCoord", 0, 1000);
  info.number("scale");
  info.number("strength");
  info.extension("KHR_texture_transform", [](const At& transform) {
    transform.numbers("offset", 2);
    transform.numbers("scale", 2);
    transform.number("rotation");
    transform.integer("texCoord", 0, 1000);
  });
}

void check_material(const At& root, const At& material) {
  const auto texture = [&](const At& info) { check_texture(root, info); };
  material.text("name");
  material.object("pbrMetallicRoughness", [&](const At& pbr) {
    pbr.numbers("baseColorFactor", 4);
    pbr.number("metallicFactor");
    pbr.number("roughnessFactor");
    pbr.object("baseColorTexture", texture);
    pbr.object("metallicRoughnessTexture", texture);
  });
  for (const char* name : {"normalTexture", "occlusionTexture", "emissiveTexture"}) material.object(name, texture);
  material.numbers("emissiveFactor", 3);
  material.text("alphaMode");
  material.number("alphaCutoff");
  material.flag("doubleSided");
  material.extension("KHR_materials_emissive_strength", [](const At& e) { e.number("emissiveStrength"); });
  material.extension("KHR_materials_unlit", [](const At&) {});
  material.extension("KHR_materials_ior", [](const At& e) { e.number("ior"); });
  material.extension("KHR_materials_specular", [&](const At& specular) {
    specular.number("specularFactor");
    specular.numbers("specularColorFactor", 3);
    specular.object("specularTexture", texture);
    specular.object("specularColorTexture", texture);
  });
}

}  // namespace

void check_materials(const At& root) {
  root.objects("materials", [&](const At& material) { check_material(root, material); });
  root.objects("textures", [&](const At& row) {
    row.index("source", "images", root.rows("images"));
    row.index("sampler", "samplers", root.rows("samplers"));
  });
  root.objects("images", [&](const At& image) {
    image.text("name");
    image.text("uri");
    image.index("bufferView", "bufferViews", root.rows("bufferViews"));
    if (image.has("uri") == image.has("bufferView")) refuse("{} needs either a uri or a bufferView", image.path);
  });
  root.objects("samplers", [](const At& sampler) {
    for (const char* name : {"magFilter", "minFilter", "wrapS", "wrapT"}) sampler.integer(name, 0, 65535);
  });
}

void check_cameras_and_lights(const At& root) {
  root.objects("cameras", [](const At& camera) {
    camera.text("name");
    camera.require("type");
    camera.text("type");
    camera.object("perspective", [](const At& perspective) {
      for (const char* name : {"yfov", "znear", "zfar", "aspectRatio"}) perspective.number(name);
    });
  });
  size_t light_count = 0;
  root.object("extensions", [&](const At& extensions) {
    extensions.object("KHR_lights_punctual", [&](const At& extension) {
      light_count = extension.rows("lights");
      extension.objects("lights", [](const At& light) {
        light.text("name");
        light.require("type");
        light.text("type");
        light.numbers("color", 3);
        light.number("intensity");
        light.number("range");
        light.object("spot", [](const At& spot) {
          spot.number("innerConeAngle");
          spot.number("outerConeAngle");
        });
      });
    });
  });
  root.objects("nodes", [&](const At& node) {
    node.object("extensions", [&](const At& extensions) {
      extensions.object("KHR_lights_punctual", [&](const At& use) {
        use.require("light");
        use.index("light", "lights", light_count);
      });
    });
  });
}

void check_skins_and_animations(const At& root) {
  root.objects("skins", [&](const At& skin) {
    skin.text("name");
    skin.index("inverseBindMatrices", "accessors", root.rows("accessors"));
    skin.index("skeleton", "nodes", root.rows("nodes"));
    skin.require("joints");
    skin.indices("joints", "nodes", root.rows("nodes"));
    if (skin.value["joints"].empty()) refuse("{} is empty", skin.key("joints"));
  });
  root.objects("animations", [&](const At& animation) {
    animation.text("name");
    animation.require("samplers");
    animation.objects("samplers", [&](const At& sampler) {
      for (const char* name : {"input", "output"}) {
        sampler.require(name);
        sampler.index(name, "accessors", root.rows("accessors"));
      }
      sampler.word("interpolation", {"LINEAR", "STEP", "CUBICSPLINE"});
    });
    animation.require("channels");
    animation.objects("channels", [&](const At& channel) {
      channel.require("sampler");
      channel.index("sampler", "samplers in this animation", animation.rows("samplers"));
      channel.require("target");
      channel.object("target", [&](const At& target) {
        target.index("node", "nodes", root.rows("nodes"));
        target.require("path");
        target.text("path");
      });
    });
  });
}

}  // namespace nf::scene::gltf
