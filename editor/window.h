// A window with a swapchain, by GLFW. Everything that happens to it goes into the input queue.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "ui/input.h"

struct GLFWwindow;

namespace nf::gpu {
class Swapchain;
}

namespace nf::editor {

class Window {
 public:
  // Throws nf::Error (Exit::NoDevice) when there is no display.
  Window(glm::uvec2 size, const std::string& title, ui::InputQueue& input);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // For DeviceOptions, before attach().
  std::vector<std::string> extensions() const;
  void attach(gpu::Device& device);
  // Before that device goes.
  void detach();
  void present(glm::uvec2 size, std::span<const std::byte> rgba);
  // Events that are there, or those that come within `seconds`.
  void poll(double seconds);
  void set_title(const std::string& title);
  void set_size(glm::uvec2 size);
  void toggle_fullscreen();
  glm::uvec2 size() const;  // pixels; zero while minimised
  float scale() const;
  std::string clipboard() const;
  void set_clipboard(const std::string& text);

 private:
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gpu::Swapchain> swapchain_;
  glm::ivec4 windowed_{0};
};

}  // namespace nf::editor
