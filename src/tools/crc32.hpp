// CRC-32 as zip's, over bytes that come in parts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace fail_aware {

class Crc32 {
 public:
  void add(const char* bytes, std::size_t count) {
    static const std::array<std::uint32_t, 256> kTable = table();
    for (std::size_t i = 0; i < count; ++i) {
      crc_ = kTable[(crc_ ^ static_cast<unsigned char>(bytes[i])) & 0xFFu] ^ (crc_ >> 8u);
    }
  }
  std::uint32_t value() const { return ~crc_; }

 private:
  static std::array<std::uint32_t, 256> table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value & 1u) != 0u ? 0xEDB88320u ^ (value >> 1u) : value >> 1u;
      table[i] = value;
    }
    return table;
  }

  std::uint32_t crc_ = 0xFFFFFFFFu;
};

}  // namespace fail_aware
