#include "core/io/sweep_source.hpp"

namespace fail_aware {

const char* toString(ReadStatus status) {
  switch (status) {
    case ReadStatus::kOk: return "ok";
    case ReadStatus::kSideFileUnusable: return "side_file_unusable";
    case ReadStatus::kUnreadable: return "unreadable";
    case ReadStatus::kTruncated: return "truncated";
    case ReadStatus::kEmpty: return "empty";
    case ReadStatus::kNoFinitePoint: return "no_finite_point";
  }
  return "unknown";
}

}  // namespace fail_aware
