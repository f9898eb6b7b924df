#include "core/initial_guess/first_sweep_matcher.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace fail_aware {

namespace {

// Probability that a place meets nothing at the right pose: it was hidden, or it moves. On 135 starts at highway speed
// and in open country 0.05 to 0.2 find the speed equally often.
constexpr double kUnmet = 0.1;
// The vote of a point that something hid from the first sweep: about that of a point that is seen twice. Of 120 starts
// on highways 115 find the speed if such a point counts as one that meets nothing, 118 with 0.5, 119 with 0.7 and 0.9.
constexpr double kHidden = 0.7;
constexpr double kMet = 0.5;  // a place with this vote meets the first sweep

}  // namespace

FirstSweepMatch FirstSweepMatcher::match(const Pose& T_first_now, double kernel_m, HiddenPoints hidden) const {
  const bool have_a_vote = hidden == HiddenPoints::kHaveAVote;
  const std::vector<double> votes = votesOfPlaces(
      now_, first_, T_first_now, kernel_m,
      [&](const Eigen::Vector3d& point) { return have_a_vote && hidden_in_first_.hides(point) ? kHidden : 0.0; });
  FirstSweepMatch match;
  std::size_t met = 0;
  for (const double vote : votes) {
    match.log_likelihood += std::log(vote + kUnmet);
    match.votes += vote;
    met += vote >= kMet ? 1 : 0;
  }
  if (met > 0) match.met_ratio = static_cast<double>(met) / static_cast<double>(votes.size());
  return match;
}

}  // namespace fail_aware
