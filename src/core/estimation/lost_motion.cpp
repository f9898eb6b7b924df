#include "core/estimation/lost_motion.hpp"

namespace fail_aware {

namespace {

constexpr int kLongDeadReckoning = 10;  // sweeps; in a shorter time the speed hardly changes
constexpr int kWatched = 50;            // sweeps after dead reckoning: false minima may fit well at first
constexpr double kUsualRatio = 0.85;    // in town and country, before it is known from the drive
// Of the usual ratio. With a speed that was nearly right it is above 0.9 within five sweeps after a tunnel, within
// nine after fog or a covered sector; in false minima it is 0.4 to 0.7.
constexpr double kLost = 0.65;

}  // namespace

bool LostMotion::add(bool dead_reckoned, const std::optional<double>& inlier_ratio) {
  if (believed_ratio_ == 0.0) return false;
  if (!inlier_ratio) {
    dead_reckoned_sweeps_ = watched_sweeps_ = 0;
    recent_ratio_.clear();
    return false;
  }
  dead_reckoned_sweeps_ = dead_reckoned ? dead_reckoned_sweeps_ + 1 : 0;
  if (dead_reckoned_sweeps_ >= kLongDeadReckoning) {
    watched_sweeps_ = kWatched;
  } else if (watched_sweeps_ > 0) {
    --watched_sweeps_;
  }
  recent_ratio_.add(*inlier_ratio);
  if (!dead_reckoned && watched_sweeps_ == 0) usual_ratio_.add(*inlier_ratio);
  if (watched_sweeps_ == 0 || !recent_ratio_.isFull()) return false;
  if (!usual_ratio_.isFull() && !usual_is_assumed_) return false;
  const double usual = usual_ratio_.isFull() ? usual_ratio_.median() : kUsualRatio;
  const double recent = recent_ratio_.median();
  if (recent < believed_ratio_ || recent >= kLost * usual) return false;
  clear();
  usual_is_assumed_ = false;
  return true;
}

}  // namespace fail_aware
