// Typed indices. Tables are addressed by handles, never by pointers, so that they can grow and be copied.
#pragma once

#include <compare>
#include <cstdint>

namespace nf {

template <class Tag>
struct Handle {
  uint16_t id = 0xffff;
  constexpr bool valid() const { return id != 0xffff; }
  constexpr explicit operator bool() const { return valid(); }
  constexpr auto operator<=>(const Handle&) const = default;
};

}  // namespace nf
