#include "core/preprocessing/profile_equations.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

// Sigma of the true lean of walls, of trunks and poles, and of the latter towards the sensor: those of what people
// build, in addition to the standard error.
constexpr double kSurface_deg = 0.1, kLine_deg = 0.3, kLineAway_deg = 0.5;
constexpr double kPoint_m = 0.015;  // sigma of a point's offset
constexpr double kBeam_m = 0.003;   // sigma of a beam's mean offset, in addition
constexpr double kEdge_m = 0.006;   // the same for trunks and poles: their edges fall between two columns of the head

}  // namespace

ProfileEquations::ProfileEquations(const UprightProfile& profile, const std::vector<UprightProfile::Beam>& beams,
                                   const std::vector<BeamRange>& ranges, const Eigen::MatrixXd& P) {
  const auto n = static_cast<Eigen::Index>(profile.size);
  const bool surface = profile.kind == UprightProfile::Kind::kSurface;
  const Eigen::Vector2d& m = profile.direction;
  of = {VerticalState::kTilt, VerticalState::kTilt + 1, VerticalState::kJitter, VerticalState::kJitter + 1,
        VerticalState::kElevation};
  constexpr Eigen::Index kShared = 5;
  Eigen::VectorXd w(n), z(n), y(n), oblique(n), rest(n);
  double known = 0.0;  // mean variance that the errors of the ranges explain, in units of the noise's
  for (Eigen::Index i = 0; i < n; ++i) {
    const UprightProfile::Beam& beam = beams[profile.first + static_cast<std::size_t>(i)];
    const Eigen::Index at = VerticalState::kBeams + beam.ring;
    of.push_back(at);
    const double common = std::hypot(kBeam_m, surface ? 0.0 : kEdge_m);
    w[i] = 1.0 / (common * common + kPoint_m * kPoint_m / static_cast<double>(beam.points));
    z[i] = static_cast<double>(beam.height_m);
    oblique[i] = static_cast<double>(beam.obliqueness);
    rest[i] = static_cast<double>(beam.offset_m);
    const double corrected = beam.ring < ranges.size() ? static_cast<double>(ranges[beam.ring].too_far_m) : 0.0;
    y[i] = rest[i] + oblique[i] * corrected;
    known += w[i] * oblique[i] * oblique[i] * P(at, at) / static_cast<double>(n);
  }
  const double total = w.sum();
  z.array() -= w.dot(z) / total;
  y.array() -= w.dot(y) / total;
  const Eigen::VectorXd root = w.cwiseSqrt();
  const Eigen::VectorXd unit = root.cwiseProduct(z).normalized();  // of the weighted equations: the lean
  // how much less straight the profile is than the noise allows
  rest.array() -= w.dot(rest) / total;
  rest = root.cwiseProduct(rest).eval();
  rest -= unit * unit.dot(rest);
  const double roughness = std::max(1.0, rest.squaredNorm() / static_cast<double>(n - 2) / (1.0 + known));
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, kShared + n);
  A.col(0) = A.col(2) = -m.y() * z;
  A.col(1) = A.col(3) = m.x() * z;
  A.col(4) = m.dot(profile.away) * z;
  A.rightCols(n).diagonal() = oblique;
  A.rightCols(n).rowwise() -= (w.cwiseProduct(oblique) / total).transpose();
  A = ((root / std::sqrt(roughness)).asDiagonal() * A).eval();
  Eigen::VectorXd b = root.cwiseProduct(y) / std::sqrt(roughness);
  lean = A.transpose() * unit;
  lean_value = unit.dot(b);
  straight = A - unit * lean.transpose();
  straight_values = b - unit * lean_value;
  // to unit variance, that of the true lean included
  const double sigma =
      surface ? kSurface_deg : (profile.kind == UprightProfile::Kind::kLineAway ? kLineAway_deg : kLine_deg);
  const double per_lean2 = w.dot(z.cwiseProduct(z)) / roughness;
  const double scale = 1.0 / std::sqrt(1.0 + per_lean2 * std::pow(sigma * kDegree, 2));
  lean *= scale;
  lean_value *= scale;
}

Eigen::VectorXd ProfileEquations::pick(const Eigen::VectorXd& x) const {
  Eigen::VectorXd picked(static_cast<Eigen::Index>(of.size()));
  for (std::size_t i = 0; i < of.size(); ++i) picked[static_cast<Eigen::Index>(i)] = x[of[i]];
  return picked;
}

double ProfileEquations::leanVariance(const Eigen::MatrixXd& P) const {
  double variance = 0.0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    for (std::size_t j = 0; j < of.size(); ++j) {
      variance += lean[static_cast<Eigen::Index>(i)] * P(of[i], of[j]) * lean[static_cast<Eigen::Index>(j)];
    }
  }
  return variance;
}

}  // namespace fail_aware
