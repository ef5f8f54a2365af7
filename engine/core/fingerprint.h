// One number for whatever decides a result: FNV-1a, 64 bit.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace nf {

class Fingerprint {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    add_bytes(&value, sizeof value);
  }
  template <class T>
  void add(const std::vector<T>& rows) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(rows.size());
    if (!rows.empty()) add_bytes(rows.data(), rows.size() * sizeof(T));
  }
  void add(const std::string& text) { add(std::string_view(text)); }
  void add(std::string_view text) {
    add(text.size());
    add_bytes(text.data(), text.size());
  }
  uint64_t value() const { return hash_; }

 private:
  void add_bytes(const void* data, size_t size) {
    const auto* bytes = static_cast<const uint8_t*>(data);
    for (size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001B3u;
  }
  uint64_t hash_ = 0xCBF29CE484222325u;
};

}  // namespace nf
