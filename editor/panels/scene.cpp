// The scene: its numbers, cameras and bookmarks, lights, and the clock.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <imgui.h>

#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

constexpr float degrees = 57.29578f;

// Azimuth and elevation of where the sun stands, dragged on a hemisphere seen from above.
bool draw_sun_direction(const std::string& id, glm::vec3& direction) {
  const float size = ImGui::GetFontSize() * 6;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton(id.c_str(), ImVec2(size, size));
  const glm::vec3 to_sun = -glm::normalize(direction);
  ui::note(id, fmt::format("{:.3f} {:.3f} {:.3f}", direction.x, direction.y, direction.z));
  ui::tooltip("Drag: where the sun stands, seen from above; the rim is the horizon");
  bool changed = false;
  glm::vec2 p = glm::vec2(to_sun.x, to_sun.z);
  const float flat = glm::length(p);
  const float elevation = std::asin(std::clamp(to_sun.y, -1.0f, 1.0f));
  const float radius = std::clamp(1 - elevation * degrees / 90, 0.0f, 1.0f);
  p = flat > 1e-6f ? p / flat * radius : glm::vec2(0);
  if (ImGui::IsItemActive()) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    glm::vec2 q((mouse.x - low.x) / size * 2 - 1, (mouse.y - low.y) / size * 2 - 1);
    const float r = std::min(glm::length(q), 0.995f);
    if (glm::length(q) > 1e-6f) q = glm::normalize(q) * r;
    const float e = (1 - r) * 90 / degrees;
    const float c = std::cos(e);
    const glm::vec2 around = r > 1e-6f ? glm::normalize(q) : glm::vec2(1, 0);
    const glm::vec3 now = -glm::vec3(around.x * c, std::sin(e), around.y * c);
    changed = now != direction;
    direction = now;
    p = q;
  }
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 middle(low.x + size / 2, low.y + size / 2);
  list->AddCircleFilled(middle, size / 2, IM_COL32(40, 60, 90, 255), 48);
  list->AddCircle(middle, size / 4, IM_COL32(255, 255, 255, 40), 48);
  list->AddCircleFilled(ImVec2(middle.x + p.x * size / 2, middle.y + p.y * size / 2), size * 0.06f,
                        IM_COL32(255, 220, 100, 255));
  return changed;
}

// Round the vertical, and up and down. Not quite to the poles, where the first would be lost.
void draw_aim(const std::string& id, glm::vec3& direction) {
  const glm::vec3 d = glm::normalize(direction);
  float turn = std::atan2(d.x, -d.z) * degrees, tilt = std::asin(std::clamp(d.y, -1.0f, 1.0f)) * degrees;
  bool changed = ui::slider(id + ".turn", "turn", turn, -180, 180, "%.1f deg");
  ui::tooltip("Where it is aimed, round the vertical: 0 is along -Z, 90 along +X");
  changed |= ui::slider(id + ".tilt", "tilt", tilt, -89.9f, 89.9f, "%.1f deg");
  ui::tooltip("Where it is aimed: -90 is down");
  if (changed) {
    const float a = turn / degrees, e = tilt / degrees;
    direction = {std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e)};
  }
  ui::note(id + ".direction", fmt::format("{:.3f} {:.3f} {:.3f}", direction.x, direction.y, direction.z));
}

void draw_lights(Editor& editor) {
  live::SceneLights& lights = editor.document.lights;
  for (size_t i = 0; i < lights.directional.size(); ++i) {
    scene::DirectionalLight& sun = lights.directional[i];
    ImGui::PushID(int(i));
    const std::string id = fmt::format("scene.sun.{}", i);
    ImGui::Text("sun %zu", i);
    draw_sun_direction(id + ".direction", sun.direction);
    ImGui::SameLine();
    ImGui::BeginGroup();
    ImGui::PushItemWidth(ImGui::GetFontSize() * 8);
    ui::slider(id + ".irradiance", "W/m2", sun.irradiance, 0, 30, "%.2f");
    ui::color(id + ".color", "", &sun.color.x);
    ui::slider(id + ".angle", "deg", sun.angle_deg, 0, 5, "%.2f");
    ImGui::PopItemWidth();
    if (ui::button(id + ".remove", "remove")) {
      lights.directional.erase(lights.directional.begin() + long(i));
      ImGui::EndGroup();
      ImGui::PopID();
      break;
    }
    ImGui::EndGroup();
    ImGui::PopID();
  }
  for (size_t i = 0; i < lights.punctual.size(); ++i) {
    scene::PunctualLight& lamp = lights.punctual[i];
    const bool spot = lamp.outer_cone < 3.14f;
    ImGui::PushID(int(1000 + i));
    const std::string id = fmt::format("scene.lamp.{}", i);
    const bool open = ImGui::TreeNode("lamp", "%s %zu  %.1f W/sr", spot ? "spot" : "point", i, double(lamp.intensity));
    ui::note(id, spot ? "spot" : "point");
    if (open) {
      ImGui::PushItemWidth(-ImGui::GetFontSize() * 4);
      ImGui::DragFloat3("at", &lamp.position.x, 0.02f);
      ui::note(id + ".position", fmt::format("{:g} {:g} {:g}", lamp.position.x, lamp.position.y, lamp.position.z));
      ui::slider(id + ".intensity", "W/sr", lamp.intensity, 0, 1000, "%.2f", true);
      ui::color(id + ".color", "colour", &lamp.color.x);
      ui::slider(id + ".radius", "radius", lamp.radius, 0, 1, "%.3f m");
      if (spot) {
        float outer = lamp.outer_cone * degrees, inner = lamp.inner_cone * degrees;
        if (ui::slider(id + ".cone", "cone", outer, 1, 89, "%.1f deg")) {
          lamp.outer_cone = outer / degrees;
          lamp.inner_cone = std::min(lamp.inner_cone, lamp.outer_cone);
        }
        ui::tooltip("Half the angle of the cone, outside of which it is dark");
        if (ui::slider(id + ".inner", "inner", inner, 0, 89, "%.1f deg")) {
          lamp.inner_cone = inner / degrees;
          lamp.outer_cone = std::max(lamp.inner_cone, lamp.outer_cone);
        }
        ui::tooltip("Half the angle of the cone in which it is at its full intensity");
        draw_aim(id, lamp.direction);
      }
      ImGui::PopItemWidth();
      if (ui::button(id + ".here", "to the camera", "Where the camera stands, aimed as it looks")) {
        lamp.position = editor.view.camera.position;
        lamp.direction = glm::normalize(editor.view.camera.forward);
      }
      ImGui::SameLine();
      const bool remove = ui::button(id + ".remove", "remove");
      ImGui::TreePop();
      if (remove) {
        lights.punctual.erase(lights.punctual.begin() + long(i));
        ImGui::PopID();
        break;
      }
    }
    ImGui::PopID();
  }
  if (ui::button("scene.add_point", "add point", "Where the camera is aimed, one metre before what it orbits")) {
    scene::PunctualLight lamp;
    lamp.position = editor.view.camera.position +
                    glm::normalize(editor.view.camera.forward) *
                        std::max(glm::length(editor.view.target - editor.view.camera.position) - 1, 0.5f);
    lamp.intensity = 10;
    lights.punctual.push_back(lamp);
  }
  ImGui::SameLine();
  if (ui::button("scene.add_spot", "add spot", "Where the camera stands, aimed as it looks")) {
    scene::PunctualLight lamp;
    lamp.position = editor.view.camera.position;
    lamp.direction = glm::normalize(editor.view.camera.forward);
    lamp.intensity = 50;
    lamp.outer_cone = 30 / degrees;
    lamp.inner_cone = 20 / degrees;
    lights.punctual.push_back(lamp);
  }
  ImGui::SameLine();
  if (ui::button("scene.add_sun", "add sun"))
    lights.directional.push_back({.direction = glm::normalize(glm::vec3(-0.4f, -1, -0.3f)), .irradiance = 3});
  if (editor.scene.environment.kind == scene::EnvironmentKind::Constant)
    ui::color("scene.environment", "environment", &lights.environment.x);
  else
    ImGui::TextDisabled("environment: %s", editor.scene.environment.kind == scene::EnvironmentKind::Map
                                               ? std::filesystem::path(editor.scene.environment.file).filename().c_str()
                                               : "gradient");
}

void draw_cameras(Editor& editor) {
  CameraControl& view = editor.view;
  for (size_t i = 0; i < editor.scene.cameras.size(); ++i) {
    if (i % 3) ImGui::SameLine();
    const std::string& name = editor.scene.cameras[i].name;
    if (ui::button(fmt::format("scene.camera.{}", i), name.empty() ? fmt::format("camera {}", i) : name))
      go_to(editor, editor.scene.cameras[i]);
  }
  float fov = view.camera.vfov * degrees;
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 9);
  if (ui::slider("scene.vfov", "vertical fov", fov, 5, 150, "%.1f deg"))
    view.camera.vfov = fov / degrees, view.moved = true;
  ImGui::TextDisabled("%.2f %.2f %.2f, fly %.2f m/s", double(view.camera.position.x), double(view.camera.position.y),
                      double(view.camera.position.z), double(view.speed));
  ImGui::TextUnformatted("bookmarks");
  for (size_t i = 0; i < editor.document.bookmarks.size(); ++i) {
    std::optional<scene::Camera>& bookmark = editor.document.bookmarks[i];
    ImGui::SameLine();
    const std::string label = fmt::format("{}{}", i + 1, bookmark ? "*" : "");
    if (ui::button(fmt::format("scene.bookmark.{}", i + 1), label,
                   "Click goes there; Ctrl+click, or Ctrl and the number, keeps the camera")) {
      if (ImGui::GetIO().KeyCtrl || !bookmark)
        bookmark = view.camera;
      else
        go_to(editor, *bookmark);
    }
  }
}

}  // namespace

void go_to(Editor& editor, const scene::Camera& camera) {
  CameraControl& c = editor.view;
  c.camera = camera;
  c.camera.node = scene::none;
  c.camera.forward = glm::normalize(camera.forward);
  const glm::vec3 middle = (editor.scene.bounds.min + editor.scene.bounds.max) * 0.5f;
  const float size = glm::length(editor.scene.bounds.max - editor.scene.bounds.min);
  const float ahead = glm::dot(middle - camera.position, c.camera.forward);
  c.target =
      camera.position + c.camera.forward * std::clamp(ahead, 0.1f * std::max(size, 0.1f), 2 * std::max(size, 0.1f));
  c.speed = std::max(size * 0.15f, 0.05f);
  c.moved = true;
}

void draw_scene_panel(Editor& editor) {
  ImGui::BeginChild("scene");
  const live::SceneInfo& s = editor.scene;
  ImGui::TextWrapped("%s", std::filesystem::path(s.path).filename().string().c_str());
  ui::note("scene.name", s.path);
  ImGui::TextDisabled("%llu triangles, %zu instances, %zu materials, %zu textures",
                      static_cast<unsigned long long>(s.triangles), s.instances, s.materials, s.textures);
  if (ImGui::CollapsingHeader("Cameras", ImGuiTreeNodeFlags_DefaultOpen)) draw_cameras(editor);
  if (ImGui::CollapsingHeader("Lights", ImGuiTreeNodeFlags_DefaultOpen)) draw_lights(editor);
  if (ImGui::CollapsingHeader("Time", ImGuiTreeNodeFlags_DefaultOpen)) {
    if (ui::button("scene.play", editor.wanted.playing ? "pause" : "play", "Space"))
      editor.wanted.playing = !editor.wanted.playing;
    ImGui::SameLine();
    if (ui::button("scene.step", "step", "One frame of the clock (.)")) ++editor.wanted.steps;
    ImGui::SameLine();
    bool fixed = editor.wanted.step > 0;
    if (ui::checkbox("scene.fixed", "fixed 1/60 s", fixed,
                     "Each frame is 1/60 s however long it takes; else as the wall clock"))
      editor.wanted.step = fixed ? 1.0 / 60 : 0;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("freeze");
    ImGui::SameLine();
    ui::checkbox("scene.freeze_history", "history", editor.freeze.history,
                 "What frames accumulate stays as it is now: new frames read it and leave nothing behind. A changed "
                 "parameter, light or size begins another history first");
    ImGui::SameLine();
    ui::checkbox(
        "scene.freeze_noise", "noise", editor.freeze.noise,
        "Every frame takes the samples that the last one took. Where nothing averages frames they do so anyway");
    ImGui::SameLine();
    ui::checkbox("scene.freeze_culling", "culling", editor.freeze.culling,
                 "What this camera does not see is not drawn, wherever one looks from; shadows are not concerned");
    ImGui::Text("%.3f s", editor.scene_time);
    ui::note("scene.time", fmt::format("{:.4f}", editor.scene_time));
    if (s.clips.empty())
      ImGui::TextDisabled("no animation");
    else
      ImGui::TextDisabled("%zu clips, %.2f s", s.clips.size(), double(s.duration));
  }
  int seed = int(editor.document.seed);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
  if (ImGui::InputInt("seed", &seed)) editor.document.seed = uint32_t(std::max(seed, 0));
  ui::note("scene.seed", fmt::format("{}", seed));
  ImGui::EndChild();
}

}  // namespace nf::editor
