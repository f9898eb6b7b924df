// The fuzz targets without clang: each takes its committed inputs (test/fuzz/corpus) and many seeded changes of them. A
// failure leaves its input behind; scripts/fuzz looks farther.
#include <gtest/gtest.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "fuzz_support.hpp"

// Their LLVMFuzzerTestOneInput, by the names of CMakeLists.txt.
extern "C" {
int kitti_directory_fuzz(const std::uint8_t* data, std::size_t size);
int parameters_fuzz(const std::uint8_t* data, std::size_t size);
int text_files_fuzz(const std::uint8_t* data, std::size_t size);
#ifdef FAIL_AWARE_WITH_BRIDGE
int messages_fuzz(const std::uint8_t* data, std::size_t size);
int point_cloud_fuzz(const std::uint8_t* data, std::size_t size);
#endif
}

namespace fail_aware::replay_test {
namespace {

using Input = std::vector<std::uint8_t>;

struct Target {
  const char* name;
  int (*run)(const std::uint8_t* data, std::size_t size);
  int changes;  ///< of all its inputs together
};

const Target kTargets[] = {
    {"kitti_directory", kitti_directory_fuzz, 3000},
    {"parameters", parameters_fuzz, 1000},
    {"text_files", text_files_fuzz, 3000},
#ifdef FAIL_AWARE_WITH_BRIDGE
    {"messages", messages_fuzz, 1500},
    {"point_cloud", point_cloud_fuzz, 20000},
#endif
};

constexpr std::size_t kLargestFile = 4096;

struct File {
  std::string name;
  Input bytes;
};

std::vector<File> corpusOf(const Target& target) {
  std::vector<File> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(FAIL_AWARE_FUZZ_CORPUS) + '/' + target.name)) {
    std::ifstream file(entry.path(), std::ios::binary);
    files.push_back({entry.path().filename().string(), {std::istreambuf_iterator<char>(file), {}}});
  }
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.name < b.name; });
  return files;
}

/// One to eight steps: bits, bytes, pieces taken out, doubled or put in from another input.
Input changed(Input bytes, const Input& other, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return end == 0 ? 0 : random() % end; };  // the same for every library
  const auto at = [&](Input& input, std::size_t i) { return input.begin() + static_cast<std::ptrdiff_t>(i); };
  for (std::size_t steps = 1 + below(8); steps > 0; --steps) {
    const std::size_t i = below(bytes.size()), length = 1 + below(16), end = std::min(bytes.size(), i + length);
    const std::uint8_t usual[] = {0, 1, 0x7f, 0x80, 0xff, '-', '\n', ' '};
    switch (below(6)) {
      case 0:
        if (!bytes.empty()) bytes[i] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:
        if (!bytes.empty()) bytes[i] = static_cast<std::uint8_t>(random());
        break;
      case 2:
        if (!bytes.empty()) bytes[i] = usual[below(8)];
        break;
      case 3: bytes.erase(at(bytes, i), at(bytes, end)); break;
      case 4: {
        const Input piece(at(bytes, i), at(bytes, end));
        bytes.insert(at(bytes, i), piece.begin(), piece.end());
        break;
      }
      default: {
        const std::size_t from = below(other.size()), to = std::min(other.size(), from + 4 * length);
        bytes.insert(at(bytes, i), other.begin() + static_cast<std::ptrdiff_t>(from),
                     other.begin() + static_cast<std::ptrdiff_t>(to));
      }
    }
  }
  return bytes;
}

class FuzzReplay : public testing::TestWithParam<Target> {
 protected:
  void TearDown() override { std::filesystem::remove_all(ownFolder()); }

  static void run(const Target& target, const Input& bytes, const std::string& what) {
    try {
      target.run(bytes.data(), bytes.size());
    } catch (const std::exception& error) {
      const std::string file = testing::TempDir() + target.name + "_input";
      writeFile(file, std::string(bytes.begin(), bytes.end()));
      ADD_FAILURE() << target.name << ", " << what << ": " << error.what() << "; the input: " << file;
    }
  }
};

std::ostream& operator<<(std::ostream& out, const Target& target) { return out << target.name; }

TEST_P(FuzzReplay, KeepsItsPromisesOverTheCorpusAndChangesOfIt) {
  const Target& target = GetParam();
  const std::vector<File> files = corpusOf(target);
  ASSERT_FALSE(files.empty());
  std::mt19937 random(1);
  run(target, {}, "no byte");
  for (const File& file : files) {
    EXPECT_LT(file.bytes.size(), kLargestFile) << file.name;
    run(target, file.bytes, file.name);
    for (int i = 0; i < target.changes / static_cast<int>(files.size()) && !HasFailure(); ++i) {  // one is enough
      const Input& other = files[random() % files.size()].bytes;
      run(target, changed(file.bytes, other, random), file.name + ", change " + std::to_string(i));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzReplay, testing::ValuesIn(kTargets),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace fail_aware::replay_test
