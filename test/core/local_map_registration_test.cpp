#include "core/local_map_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "../support/synthetic_drive.hpp"
#include "core/geometry/degree.hpp"
#include "core/preprocessing/correction.hpp"

namespace fail_aware::local_map_registration_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// mean distance of a sweep's points to the scene: of noise alone, and where 12 m/s was not corrected for
constexpr double kStraight_m = 0.012, kBent_m = 0.035;

LocalMapRegistration makeFront(bool refine_deskew, int min_points = 500, bool search_turn = true,
                               bool match_above_ground = true, const SweepTimingParams& timing = {}) {
  RegistrationParameters params;
  params.refine_deskew = refine_deskew;
  params.deskew_refinement.enabled = search_turn;
  params.above_ground.reference.enabled = match_above_ground;
  params.cloud.min_range_m = 3.0;
  params.cloud.max_range_m = 60.0;
  params.cloud.min_points = min_points;
  params.reference.sweeps = 0;
  params.initialization.max_range_m = 40.0;
  return LocalMapRegistration(params, timing);
}

SyntheticDrive curve() {
  SyntheticDrive drive;
  drive.twist_cog = planarTwist(12.0, 0.2);
  drive.car_ahead = false;
  return drive;
}

/// The filter's words about a sweep dt after the last: predicted to have moved by `increment`.
SweepPrediction predictionOf(double stamp_s, double dt_s, const Pose& T_previous, const Pose& increment,
                             bool motion_known) {
  SweepPrediction prediction;
  prediction.stamp_s = stamp_s;
  prediction.dt_s = dt_s;
  prediction.T_odom_cog_previous = T_previous;
  prediction.T_odom_cog = T_previous * increment;
  prediction.motion_status = motion_known ? MotionStatus::kObserved : MotionStatus::kUnknown;
  return prediction;
}

FilterState stateOf(const SweepPrediction& prediction, const Pose& T_odom_cog, bool corrected) {
  FilterState state;
  state.stamp_s = prediction.stamp_s;
  state.dt_s = prediction.dt_s;
  state.T_odom_cog = T_odom_cog;
  state.T_previous_now = prediction.T_odom_cog_previous.inverse() * T_odom_cog;
  state.measurement_applied = corrected;
  state.map_update = corrected || prediction.dt_s <= 0.0 ? MapUpdate::kInsert : MapUpdate::kSkip;
  return state;
}

double distanceToScene(const Eigen::Vector3d& p, const Scene& scene) {
  double nearest = 1e9;
  for (const Rectangle& r : scene) {
    const Eigen::Vector3d d = p - r.origin;
    const double a = std::clamp(d.dot(r.side_u) / r.side_u.squaredNorm(), 0.0, 1.0);
    const double b = std::clamp(d.dot(r.side_v) / r.side_v.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (d - a * r.side_u - b * r.side_v).norm());
  }
  return nearest;
}

double meanDistance(const std::vector<Eigen::Vector3d>& points, const Scene& scene) {
  double sum = 0.0;
  for (const Eigen::Vector3d& p : points) sum += distanceToScene(p, scene);
  return sum / static_cast<double>(points.size());
}

std::vector<Eigen::Vector3d> moved(const Points& points, const Pose& T) {
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector3f& p : points) out.push_back(T * p.cast<double>());
  return out;
}

/// Runs the first sweep through a front: the filter knows nothing and starts at the origin.
void placeFirst(LocalMapRegistration& front, const SyntheticDrive& drive) {
  const SweepPrediction prediction = predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(0.0, 1), prediction, drive.T_cog_lidar));
  EXPECT_TRUE(front.map().empty());
  front.place(stateOf(prediction, Pose::Identity(), false));
  EXPECT_FALSE(front.map().empty());
}

TEST(LocalMapRegistration, StartsAtThePredictionOnceMotionIsKnown) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  placeFirst(front, drive);
  const Pose guess = poseOf(0.7, 0.1, 0.0, 0.0, 0.0, 0.5);
  ASSERT_TRUE(
      front.prepare(drive.sweep(0.1, 2), predictionOf(0.1, 0.1, Pose::Identity(), guess, true), drive.T_cog_lidar));
  EXPECT_EQ(front.T_odom_cog_start().matrix(), guess.matrix());
  EXPECT_GT(front.cloud().plane_points_cog.size(), 500u);
}

/// The drive's sweep, corrected for `twist_cog`, whatever it drove.
CorrectedSweep correctedSweep(const SyntheticDrive& drive, double stamp_s, unsigned seed, const Vector6d& twist_cog) {
  CorrectedSweep sweep = drive.sweep(stamp_s, seed);
  Sweep seen;
  seen.stamp_s = sweep.stamp_s;
  seen.points_lidar = sweep.points_lidar;
  const std::vector<float> times_s = sweep.times_s;
  correctSweep({}, seen, times_s, Pose::Identity(), expSe3(0.1 * twist_cog), 0.1, drive.T_cog_lidar, sweep);
  return sweep;
}

// The filter predicts a turn 15 deg/s slower than it is: the sweep is bent, unless the turn is looked for in it.
TEST(LocalMapRegistration, UnpredictedTurnIsRemoved) {
  SyntheticDrive drive = curve();
  drive.points_per_m2 = 20.0;
  double distances_m[2], placed_m[2];
  for (const bool search_turn : {false, true}) {
    LocalMapRegistration front = makeFront(true, 500, search_turn);
    SweepPrediction prediction = predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), false);
    SyntheticDrive standing = drive;
    standing.twist_cog.setZero();
    ASSERT_TRUE(front.prepare(standing.sweep(0.0, 1), prediction, drive.T_cog_lidar));
    front.place(stateOf(prediction, Pose::Identity(), false));
    Vector6d slower = drive.twist_cog;
    slower[5] -= 15.0 * kDegree;
    prediction = predictionOf(0.1, 0.1, Pose::Identity(), expSe3(0.1 * slower), true);
    ASSERT_TRUE(front.prepare(correctedSweep(drive, 0.1, 2, slower), prediction, drive.T_cog_lidar));
    distances_m[search_turn] = meanDistance(moved(front.cloud().map_points_cog, drive.pose(0.1)), drive.scene);
    // another turn that the filter makes of it bends the sweep anew only where none was found in it
    const Pose wrong = expSe3(0.1 * slower) * expSe3((Vector6d() << 0, 0, 0, 0, 0, -0.03).finished());
    front.place(stateOf(prediction, wrong, true));
    placed_m[search_turn] = meanDistance(moved(front.cloud().map_points_cog, drive.pose(0.1)), drive.scene);
  }
  EXPECT_GT(distances_m[false], 1.5 * kStraight_m);
  EXPECT_LT(distances_m[true], 0.7 * distances_m[false]);
  EXPECT_GT(placed_m[false], 1.3 * distances_m[false]);
  EXPECT_LT(placed_m[true], 1.1 * distances_m[true]) << "it joins the map with the turn that it was measured with";
}

/// The drive's sweep as somebody else compensated it, for `twist_cog`: without times.
CorrectedSweep compensatedSweep(const SyntheticDrive& drive, double stamp_s, unsigned seed, const Vector6d& twist_cog) {
  CorrectedSweep sweep = correctedSweep(drive, stamp_s, seed, twist_cog);
  sweep.times_s.clear();
  return sweep;
}

SweepTimingParams compensatedTiming() {
  SweepTimingParams timing;
  timing.source = "none";
  return timing;
}

// Who compensated the sweep did not know of a turn of 15 deg/s: it is found, and nothing else is taken out, though the
// filter says that the vehicle was 3 m/s faster than predicted.
TEST(LocalMapRegistration, ResidualTurnIsRemoved) {
  SyntheticDrive drive = curve();
  drive.points_per_m2 = 20.0;
  double distances_m[2];
  for (const bool search_turn : {false, true}) {
    LocalMapRegistration front = makeFront(true, 500, search_turn, true, compensatedTiming());
    SweepPrediction prediction = predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), false);
    ASSERT_TRUE(front.prepare(compensatedSweep(drive, 0.0, 1, drive.twist_cog), prediction, drive.T_cog_lidar));
    EXPECT_EQ(front.cloud().compensated, search_turn);
    front.place(stateOf(prediction, Pose::Identity(), false));
    Vector6d slower = drive.twist_cog, faster = drive.twist_cog;
    slower[5] -= 15.0 * kDegree;
    faster[0] += 3.0;
    prediction = predictionOf(0.1, 0.1, Pose::Identity(), drive.pose(0.1), true);
    ASSERT_TRUE(front.prepare(compensatedSweep(drive, 0.1, 2, slower), prediction, drive.T_cog_lidar));
    distances_m[search_turn] = meanDistance(moved(front.cloud().map_points_cog, drive.pose(0.1)), drive.scene);
    const Points measured = front.cloud().map_points_cog;
    front.place(stateOf(prediction, expSe3(0.1 * faster), true));
    EXPECT_EQ(front.cloud().map_points_cog, measured);
  }
  EXPECT_GT(distances_m[false], 1.5 * kStraight_m);
  EXPECT_LT(distances_m[true], 0.7 * distances_m[false]);
}

// The first motion is searched for as ever, and compensated sweeps are not corrected for it.
TEST(LocalMapRegistration, CompensatedSweepsStayStraight) {
  LocalMapRegistration front = makeFront(true, 500, true, true, compensatedTiming());
  const SyntheticDrive drive = curve();
  SweepPrediction prediction = predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(compensatedSweep(drive, 0.0, 1, drive.twist_cog), prediction, drive.T_cog_lidar));
  front.place(stateOf(prediction, Pose::Identity(), false));
  prediction = predictionOf(0.1, 0.1, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(compensatedSweep(drive, 0.1, 2, drive.twist_cog), prediction, drive.T_cog_lidar));
  EXPECT_LT(translationError(front.T_odom_cog_start(), drive.pose(0.1)), 0.1);
  EXPECT_LT(meanDistance(moved(front.cloud().map_points_cog, drive.pose(0.1)), drive.scene), kStraight_m);
  EXPECT_LT(meanDistance(front.map().points(), drive.scene), kStraight_m);
}

// Times that are missing for another reason (correction switched off, broken times) do not make it a compensated one.
TEST(LocalMapRegistration, NoTimesIsNotCompensated) {
  const SyntheticDrive drive = curve();
  CorrectedSweep sweep = drive.sweep(0.0, 1);
  sweep.times_s.clear();
  LocalMapRegistration front = makeFront(true);
  ASSERT_TRUE(
      front.prepare(sweep, predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), false), drive.T_cog_lidar));
  EXPECT_FALSE(front.cloud().compensated);
  EXPECT_TRUE(front.cloud().map_times_s.empty());
}

/// A field with five posts, `distance_m` along it, and scan lines, which travel with the sensor.
CorrectedSweep fieldSweep(double distance_m, double stamp_s, unsigned seed, double post_m = 0.06) {
  SyntheticDrive field;
  field.scene = {ground(-30.0, -30.0, 30.0, 30.0)};
  field.ground_rings = true;
  CorrectedSweep sweep = field.sweep(0.0, seed);
  sweep.stamp_s = stamp_s;
  SyntheticDrive posts;
  posts.scene.clear();
  for (const auto& [x, y] : {std::pair{9.0, 7.0}, {14.0, -8.0}, {21.0, 5.0}, {-12.0, 9.0}, {18.0, -15.0}}) {
    addPost(posts.scene, x - distance_m, y, post_m, 2.0);
  }
  posts.points_per_m2 = 600.0;
  const CorrectedSweep standing = posts.sweep(0.0, seed);
  sweep.points_lidar.insert(sweep.points_lidar.end(), standing.points_lidar.begin(), standing.points_lidar.end());
  sweep.times_s.insert(sweep.times_s.end(), standing.times_s.begin(), standing.times_s.end());
  return sweep;
}

// The vehicle has driven 1 m and was predicted to drive 0.6 m.
TEST(LocalMapRegistration, InOpenCountryWhatStandsTellsTheWay) {
  const Pose T_cog_lidar = SyntheticDrive().T_cog_lidar;
  IcpPointToPlane::Params params;
  params.scan_line_sigma_m = 0.0;  // with it the surfaces of this field are enough
  const IcpPointToPlane planes{params};
  double distance_m[2];
  for (const bool match_above_ground : {false, true}) {
    LocalMapRegistration front = makeFront(false, 500, false, match_above_ground);
    SweepPrediction prediction = predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), false);
    ASSERT_TRUE(front.prepare(fieldSweep(0.0, 0.0, 1), prediction, T_cog_lidar));
    front.place(stateOf(prediction, Pose::Identity(), false));
    prediction = predictionOf(0.1, 0.1, Pose::Identity(), poseOf(0.6, 0.0, 0.0, 0.0, 0.0, 0.0), true);
    ASSERT_TRUE(front.prepare(fieldSweep(1.0, 0.1, 2), prediction, T_cog_lidar));
    const Measurement measured = front.align(planes, 0.01);
    ASSERT_TRUE(measured.ok());
    distance_m[match_above_ground] = measured.T_odom_cog.translation().x();
    const Measurement above_ground = front.aboveGround();
    ASSERT_EQ(above_ground.ok(), match_above_ground);
    if (!match_above_ground) continue;
    EXPECT_NEAR(above_ground.T_odom_cog.translation().x(), 1.0, 0.05);
    EXPECT_LT(std::sqrt(above_ground.covariance(0, 0)), 0.1);
    EXPECT_GT(std::sqrt(measured.covariance(0, 0)), 0.2) << "surfaces alone know less";
  }
  EXPECT_GT(std::abs(distance_m[false] - 1.0), 0.2);
  EXPECT_NEAR(distance_m[true], 1.0, 0.05);
}

/// The heading's standard deviation in the last of three sweeps of a field, each with posts of that width.
double sigmaYawAfter(const std::vector<double>& posts_m) {
  const Pose T_cog_lidar = SyntheticDrive().T_cog_lidar;
  const IcpPointToPlane planes{IcpPointToPlane::Params()};
  LocalMapRegistration front = makeFront(false, 500, false);
  Pose T_odom_cog = Pose::Identity();
  Measurement measured;
  for (std::size_t i = 0; i < posts_m.size(); ++i) {
    const double distance_m = static_cast<double>(i), stamp_s = 0.1 * distance_m;
    const SweepPrediction prediction =
        predictionOf(stamp_s, i > 0 ? 0.1 : 0.0, T_odom_cog, poseOf(i > 0 ? 1.0 : 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), i > 0);
    const unsigned seed = static_cast<unsigned>(i + 1);
    EXPECT_TRUE(front.prepare(fieldSweep(distance_m, stamp_s, seed, posts_m[i]), prediction, T_cog_lidar));
    T_odom_cog = prediction.T_odom_cog;
    measured = front.align(planes, 0.01);
    front.place(stateOf(prediction, T_odom_cog, i > 0));
  }
  EXPECT_TRUE(measured.ok());
  return std::sqrt(measured.covariance(5, 5)) / kDegree;
}

// Pillars give the planes too much for open country to begin, too little for it to end; where more stands it ends.
TEST(LocalMapRegistration, OpenCountryEndsLaterThanItBegins) {
  constexpr double kPost_m = 0.06, kPillar_m = 2.88, kHouse_m = 3.3;
  EXPECT_LT(sigmaYawAfter({kPillar_m, kPillar_m, kPillar_m}), 0.1);
  EXPECT_GT(sigmaYawAfter({kPillar_m, kPost_m, kPillar_m}), 0.15);
  EXPECT_LT(sigmaYawAfter({kHouse_m, kPost_m, kHouse_m}), 0.1);
}

TEST(LocalMapRegistration, SecondSweepStartsAtTheSearch) {
  for (const bool refine : {true, false}) {
    LocalMapRegistration front = makeFront(refine);
    const SyntheticDrive drive = curve();
    placeFirst(front, drive);
    EXPECT_GT(meanDistance(front.map().points(), drive.scene), kBent_m);  // bent: the motion was not known
    const SweepPrediction standstill = predictionOf(0.1, 0.1, Pose::Identity(), Pose::Identity(), false);
    const CorrectedSweep sweep = drive.sweep(0.1, 2);
    ASSERT_TRUE(front.prepare(sweep, standstill, drive.T_cog_lidar));
    EXPECT_LT(translationError(front.T_odom_cog_start(), drive.pose(0.1)), 0.1);
    EXPECT_LT(rotationErrorDeg(front.T_odom_cog_start(), drive.pose(0.1)), 0.3);
    // the second sweep is straight now, and so is the first, if that is wanted
    EXPECT_LT(meanDistance(moved(front.cloud().map_points_cog, drive.pose(0.1)), drive.scene), kStraight_m);
    EXPECT_LT(meanDistance(moved(front.cloud().point_points_cog, drive.pose(0.1)), drive.scene), kStraight_m);
    if (refine) {
      EXPECT_LT(meanDistance(front.map().points(), drive.scene), kStraight_m);
    } else {
      EXPECT_GT(meanDistance(front.map().points(), drive.scene), kBent_m);
    }
  }
}

TEST(LocalMapRegistration, RefinedDeskewDoesNotShift) {
  double mean_x_m[2];
  for (const bool refine : {false, true}) {
    LocalMapRegistration front = makeFront(refine);
    const SyntheticDrive drive = curve();
    placeFirst(front, drive);
    CorrectedSweep sweep = drive.sweep(0.1, 2);
    for (float& time_s : sweep.times_s) time_s -= 0.05f;  // the stamp is at the end
    const SweepPrediction prediction =
        predictionOf(0.1, 0.1, Pose::Identity(), poseOf(0.9, 0.0, 0.0, 0.0, 0.0, 0.0), true);
    ASSERT_TRUE(front.prepare(sweep, prediction, drive.T_cog_lidar));
    front.place(stateOf(prediction, poseOf(1.2, 0.0, 0.0, 0.0, 0.0, 0.0), true));  // 3 m/s faster
    mean_x_m[refine] = 0.0;
    for (const Eigen::Vector3f& p : front.cloud().map_points_cog) mean_x_m[refine] += static_cast<double>(p.x());
    mean_x_m[refine] /= static_cast<double>(front.cloud().map_points_cog.size());
  }
  EXPECT_NE(mean_x_m[0], mean_x_m[1]);
  EXPECT_NEAR(mean_x_m[0], mean_x_m[1], 0.05);  // about the stamp it would be 3 m/s 0.05 s
}

TEST(LocalMapRegistration, WrongIntervalGivesNoMotion) {
  const SyntheticDrive drive = curve();
  const auto errorAfter = [&](bool clock_jump) {
    LocalMapRegistration front = makeFront(true);
    placeFirst(front, drive);
    const SweepPrediction prediction = predictionOf(0.1, 0.1, Pose::Identity(), drive.pose(0.1), true);
    EXPECT_TRUE(front.prepare(correctedSweep(drive, 0.1, 2, drive.twist_cog), prediction, drive.T_cog_lidar));
    FilterState state = stateOf(prediction, drive.pose(0.1), true);
    state.T_previous_now = poseOf(-5.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    state.clock_jump = clock_jump;
    front.place(state);
    return meanDistance(moved(front.cloud().map_points_cog, drive.pose(0.1)), drive.scene);
  };
  EXPECT_LT(errorAfter(true), kStraight_m);
  EXPECT_GT(errorAfter(false), kBent_m);
}

TEST(LocalMapRegistration, ALostSecondSweepDoesNotShiftTheThird) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  placeFirst(front, drive);
  const SweepPrediction lost = predictionOf(0.1, 0.1, Pose::Identity(), Pose::Identity(), false);
  EXPECT_FALSE(front.prepare(CorrectedSweep(), lost, drive.T_cog_lidar));
  front.place(stateOf(lost, Pose::Identity(), false));
  const SweepPrediction third = predictionOf(0.2, 0.1, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(0.2, 3), third, drive.T_cog_lidar));
  EXPECT_LT(translationError(front.T_odom_cog_start(), drive.pose(0.2)), 0.15);
  EXPECT_LT(rotationErrorDeg(front.T_odom_cog_start(), drive.pose(0.2)), 0.5);
  // nor bend it: the filter catches up two steps in one
  front.place(stateOf(third, drive.pose(0.2), true));
  EXPECT_LT(meanDistance(front.map().points(), drive.scene), kStraight_m);
}

// As live, where a sweep takes long: the one after a jump of the clock is skipped, and the filter goes by the stamps.
TEST(LocalMapRegistration, ClockJumpFoundAfterSkippedSweep) {
  const SyntheticDrive drive = curve();
  const auto startAfter = [&](double skipped_s, double set_back_s, double driven_s, bool told_of_the_skipped) {
    LocalMapRegistration front = makeFront(true);
    placeFirst(front, drive);
    double stamp_s = 0.0;
    const auto predictionAfter = [&](double dt_s, const Pose& T_previous) {
      stamp_s += dt_s;
      return predictionOf(stamp_s, dt_s, T_previous, expSe3(drive.twist_cog * dt_s), true);
    };
    for (int i = 1; i < 5; ++i) {
      const SweepPrediction usual = predictionAfter(0.1, drive.pose(0.1 * (i - 1)));
      EXPECT_TRUE(front.prepare(drive.sweep(0.1 * i, static_cast<unsigned>(i + 1)), usual, drive.T_cog_lidar));
      front.place(stateOf(usual, drive.pose(0.1 * i), true));
    }
    const SweepPrediction skipped = predictionAfter(skipped_s, drive.pose(0.4));
    FilterState state = stateOf(skipped, skipped.T_odom_cog, false);
    state.set_back_s = set_back_s;
    if (told_of_the_skipped) front.skip(state);
    const SweepPrediction next = predictionAfter(0.1, skipped.T_odom_cog);
    const double now_s = 0.4 + driven_s + 0.1;
    EXPECT_TRUE(front.prepare(drive.sweep(now_s, 7), next, drive.T_cog_lidar));
    return translationError(front.T_odom_cog_start(), drive.pose(now_s));
  };
  EXPECT_LT(startAfter(5.1, 0.0, 0.1, true), 0.1);
  EXPECT_GT(startAfter(5.1, 0.0, 0.1, false), 1.0) << "it would be found in any case";
  EXPECT_LT(startAfter(0.1, 0.5, 0.7, true), 0.2) << "the stamps went back a little";
  EXPECT_GT(startAfter(0.1, 0.0, 0.7, true), 1.0);
}

TEST(LocalMapRegistration, FailedSearchBeginsAnew) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  placeFirst(front, drive);
  const SweepPrediction later = predictionOf(1.5, 1.5, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(1.5, 2), later, drive.T_cog_lidar));
  EXPECT_TRUE(front.map().empty());
  front.place(stateOf(later, Pose::Identity(), false));
  EXPECT_FALSE(front.map().empty());
  const SweepPrediction next = predictionOf(1.6, 0.1, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(1.6, 3), next, drive.T_cog_lidar));
  const Pose T_1500_1600 = drive.pose(1.5).inverse() * drive.pose(1.6);
  EXPECT_LT(translationError(front.T_odom_cog_start(), T_1500_1600), 0.15);
  EXPECT_LT(rotationErrorDeg(front.T_odom_cog_start(), T_1500_1600), 0.5);
}

TEST(LocalMapRegistration, UnknownMotionUnderWayIsSearchedAnew) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  placeFirst(front, drive);
  const Pose T_100 = drive.pose(0.1), T_200 = drive.pose(0.2), T_300 = drive.pose(0.3);
  SweepPrediction known = predictionOf(0.1, 0.1, Pose::Identity(), T_100, true);
  ASSERT_TRUE(front.prepare(drive.sweep(0.1, 2), known, drive.T_cog_lidar));
  FilterState restarted = stateOf(known, T_100, true);
  restarted.map_update = MapUpdate::kRestart;
  front.place(restarted);
  // the map's only sweep is 0.1 s old, but the search does not know it
  const SweepPrediction unknown = predictionOf(0.2, 0.1, T_100, Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(0.2, 3), unknown, drive.T_cog_lidar));
  EXPECT_TRUE(front.map().empty());
  front.place(stateOf(unknown, T_200, false));
  const SweepPrediction next = predictionOf(0.3, 0.1, T_200, Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(0.3, 4), next, drive.T_cog_lidar));
  EXPECT_LT(translationError(front.T_odom_cog_start(), T_300), 0.15);
}

TEST(LocalMapRegistration, NoMotionStartsAtPrediction) {
  LocalMapRegistration front = makeFront(true);
  SyntheticDrive drive = curve();
  drive.scene = {ground(-40.0, -40.0, 40.0, 40.0)};
  placeFirst(front, drive);
  const SweepPrediction standstill = predictionOf(0.1, 0.1, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(0.1, 2), standstill, drive.T_cog_lidar));
  EXPECT_EQ(front.T_odom_cog_start().matrix(), Pose::Identity().matrix());
}

TEST(LocalMapRegistration, TooFewPointsAreNotPlaced) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  CorrectedSweep sweep = drive.sweep(0.0, 1);
  sweep.points_lidar.resize(300);
  sweep.times_s.resize(300);
  const SweepPrediction prediction = predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), false);
  EXPECT_FALSE(front.prepare(sweep, prediction, drive.T_cog_lidar));
  front.place(stateOf(prediction, Pose::Identity(), false));
  EXPECT_TRUE(front.map().empty());
}

TEST(LocalMapRegistration, APreparedSweepIsPlacedOnce) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  placeFirst(front, drive);
  const std::vector<Eigen::Vector3d> before = front.map().points();
  front.place(stateOf(predictionOf(0.1, 0.1, Pose::Identity(), Pose::Identity(), true),
                      poseOf(3.3, 0.0, 0.0, 0.0, 0.0, 0.0), true));
  EXPECT_EQ(front.map().points(), before);
}

/// A few far points, one a voxel, with times from -50 to 50 ms.
CorrectedSweep fewPoints() {
  CorrectedSweep sweep;
  for (int i = 0; i <= 10; ++i) {
    sweep.points_lidar.emplace_back(20.0f, 3.0f * static_cast<float>(i) + 0.5f, 0.5f);
    sweep.times_s.push_back(0.01f * static_cast<float>(i - 5));
  }
  return sweep;
}

std::vector<Eigen::Vector3d> sortedByY(std::vector<Eigen::Vector3d> points) {
  std::sort(points.begin(), points.end(),
            [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.y() < b.y(); });
  return points;
}

/// fewPoints() moved by the twist during the sweep.
void expectBentBy(const Vector6d& twist, const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_cog) {
  const CorrectedSweep sweep = fewPoints();
  const std::vector<Eigen::Vector3d> sorted = sortedByY(points);
  ASSERT_EQ(sorted.size(), sweep.points_lidar.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const Eigen::Vector3d expected =
        T_odom_cog * expSe3(static_cast<double>(sweep.times_s[i]) * twist) * sweep.points_lidar[i].cast<double>();
    EXPECT_LT((sorted[i] - expected).norm(), 1e-3) << i;
  }
}

TEST(LocalMapRegistration, InsertsTheRefinedSweep) {
  const Pose predicted = poseOf(1.0, 0.0, 0.0, 0.0, 0.0, 0.0), estimated = poseOf(1.2, 0.02, 0.0, 0.0, 0.0, 0.5);
  for (const bool refine : {true, false}) {
    LocalMapRegistration front = makeFront(refine, 1);
    const SweepPrediction first = predictionOf(0.0, 0.0, Pose::Identity(), Pose::Identity(), true);
    CorrectedSweep beyond;  // a first sweep that leaves nothing near the second's points
    beyond.points_lidar.emplace_back(-30.0f, -30.0f, 0.5f);
    ASSERT_TRUE(front.prepare(beyond, first, Pose::Identity()));
    front.place(stateOf(first, Pose::Identity(), false));
    const SweepPrediction second = predictionOf(0.1, 0.1, Pose::Identity(), predicted, true);
    ASSERT_TRUE(front.prepare(fewPoints(), second, Pose::Identity()));
    front.place(stateOf(second, estimated, true));
    std::vector<Eigen::Vector3d> points = sortedByY(front.map().points());
    points.erase(points.begin());  // the first sweep's
    const Vector6d missed = (logSe3(estimated) - logSe3(predicted)) / 0.1;
    expectBentBy(refine ? missed : Vector6d(Vector6d::Zero()), points, estimated);
  }
}

TEST(LocalMapRegistration, AJumpBackFromCoastingBendsNoSweep) {
  LocalMapRegistration front = makeFront(true, 1);
  const Pose step = poseOf(1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  const SweepPrediction coasted = predictionOf(0.1, 0.1, Pose::Identity(), step, true);
  ASSERT_FALSE(front.prepare(CorrectedSweep(), coasted, Pose::Identity()));
  front.place(stateOf(coasted, step, false));
  const SweepPrediction next = predictionOf(0.2, 0.1, step, step, true);
  ASSERT_TRUE(front.prepare(fewPoints(), next, Pose::Identity()));
  const Pose measured = poseOf(2.5, 0.0, 0.0, 0.0, 0.0, 0.0);  // half a metre had been missed while coasting
  front.place(stateOf(next, measured, true));
  expectBentBy(Vector6d::Zero(), front.map().points(), measured);
}

TEST(LocalMapRegistration, SkippedSweepsStayOut) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  placeFirst(front, drive);
  const std::vector<Eigen::Vector3d> before = front.map().points();
  FilterState state;
  for (int sweep = 1; sweep <= 12; ++sweep) {
    const double stamp_s = 0.1 * sweep;
    const SweepPrediction prediction = predictionOf(stamp_s, 0.1, drive.pose(stamp_s - 0.1),
                                                    drive.pose(stamp_s - 0.1).inverse() * drive.pose(stamp_s), true);
    ASSERT_TRUE(front.prepare(drive.sweep(stamp_s, 2), prediction, drive.T_cog_lidar));
    state = stateOf(prediction, prediction.T_odom_cog, false);
    state.measurement_applied = sweep == 11;  // by corners alone
    if (sweep == 12) {
      state.map_update = MapUpdate::kRestart;
    }
    front.place(state);
    if (sweep < 12) {
      ASSERT_EQ(front.map().points().size(), before.size()) << sweep;
    }
  }
  LocalMapRegistration fresh = makeFront(true);
  const SweepPrediction first = predictionOf(1.2, 0.0, Pose::Identity(), drive.pose(1.2), false);
  ASSERT_TRUE(fresh.prepare(drive.sweep(1.2, 2), first, drive.T_cog_lidar));
  fresh.place(stateOf(first, drive.pose(1.2), false));
  EXPECT_EQ(front.map().points().size(), fresh.map().points().size()) << "this sweep and nothing of what was before";
}

/// One ring each 2 deg; the fourth measures 0.06 m too far.
CorrectedSweep ringed(CorrectedSweep sweep) {
  for (Eigen::Vector3f& p : sweep.points_lidar) {
    const float elevation_deg = std::asin(p.z() / p.norm()) / static_cast<float>(kDegree);
    sweep.rings.push_back(static_cast<std::uint16_t>(std::clamp(std::floor(0.5f * elevation_deg) + 5.0f, 0.0f, 9.0f)));
    if (sweep.rings.back() == 3) p *= 1.0f + 0.06f / p.norm();
  }
  return sweep;
}

TEST(LocalMapRegistration, BeamBiasIsRemovedUntilReset) {
  LocalMapRegistration front = makeFront(false, 500, false);
  const SyntheticDrive drive = curve();
  const auto prediction = [&](int i, int epoch) {
    SweepPrediction p = predictionOf(0.1 * i, i > 0 ? 0.1 : 0.0, drive.pose(0.1 * std::max(i - 1, 0)),
                                     drive.pose(0.1 * std::max(i - 1, 0)).inverse() * drive.pose(0.1 * i), true);
    p.odom_reset_count = epoch;
    return p;
  };
  const auto sweep = [&](int i) { return ringed(drive.sweep(0.1 * i, static_cast<unsigned>(2 + i))); };
  for (int i = 0; i < 12; ++i) {
    ASSERT_TRUE(front.prepare(sweep(i), prediction(i, 0), drive.T_cog_lidar));
    front.place(stateOf(prediction(i, 0), drive.pose(0.1 * i), i > 0));
  }
  const auto moved_m = [&](int epoch) {
    LocalMapRegistration fresh = makeFront(false, 500, false);
    EXPECT_TRUE(front.prepare(sweep(12), prediction(12, epoch), drive.T_cog_lidar));
    EXPECT_TRUE(fresh.prepare(sweep(12), prediction(12, epoch), drive.T_cog_lidar));
    float largest_m = 0.0f;
    for (std::size_t i = 0; i < fresh.cloud().map_points_cog.size(); ++i) {
      const Eigen::Vector3f moved = front.cloud().map_points_cog[i] - fresh.cloud().map_points_cog[i];
      largest_m = std::max(largest_m, moved.norm());
    }
    return largest_m;
  };
  EXPECT_GT(moved_m(0), 0.02f);
  EXPECT_GT(moved_m(1), 0.02f) << "another odom, the same head";
  front.reset();
  EXPECT_EQ(moved_m(0), 0.0f);
}

TEST(LocalMapRegistration, AfterAResetTheNextSweepIsTheFirst) {
  LocalMapRegistration front = makeFront(true);
  const SyntheticDrive drive = curve();
  placeFirst(front, drive);
  front.reset();
  EXPECT_TRUE(front.map().empty());
  placeFirst(front, drive);
  const SweepPrediction standstill = predictionOf(0.1, 0.1, Pose::Identity(), Pose::Identity(), false);
  ASSERT_TRUE(front.prepare(drive.sweep(0.1, 2), standstill, drive.T_cog_lidar));
  EXPECT_LT(translationError(front.T_odom_cog_start(), drive.pose(0.1)), 0.1);
}

TEST(LocalMapRegistration, AnotherOdomRestartsTheMap) {
  const SyntheticDrive drive = curve();
  const Pose T_new_old = poseOf(50.0, -20.0, 1.0, 0.0, 0.0, 120.0);
  for (const bool state_was_heard : {true, false}) {
    LocalMapRegistration front = makeFront(true);
    placeFirst(front, drive);
    SweepPrediction prediction = predictionOf(0.1, 0.1, Pose::Identity(), drive.pose(0.1), true);
    ASSERT_TRUE(front.prepare(drive.sweep(0.1, 2), prediction, drive.T_cog_lidar));
    FilterState state = stateOf(prediction, drive.pose(0.1), true);
    state.T_odom_cog = T_new_old * drive.pose(0.1);
    state.odom_reset_count = 1;
    if (state_was_heard) {
      front.place(state);
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& p : front.map().points()) {
        mean += p / static_cast<double>(front.map().points().size());
      }
      EXPECT_LT((mean - state.T_odom_cog.translation()).norm(), 25.0) << "nothing is left of the other odom";
    }
    prediction = predictionOf(0.2, 0.1, state.T_odom_cog, drive.pose(0.1).inverse() * drive.pose(0.2), true);
    prediction.odom_reset_count = 1;
    ASSERT_TRUE(front.prepare(drive.sweep(0.2, 3), prediction, drive.T_cog_lidar));
    EXPECT_EQ(front.map().empty(), !state_was_heard) << "who did not hear the state has no reference";
  }
}

}  // namespace
}  // namespace fail_aware::local_map_registration_test
