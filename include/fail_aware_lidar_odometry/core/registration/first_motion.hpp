// What the first measurements of a drive have to know beside the surfaces that they register
// (motion_initialization.hpp).
//
// Both leave a measurement without a pose as it is.
#pragma once

#include "fail_aware_lidar_odometry/core/registration/initial_guess.hpp"
#include "fail_aware_lidar_odometry/core/types/measurement.hpp"

namespace fail_aware {

/// The first motion was found by what stands out in both sweeps, which may be too little for surfaces: where a search
/// gave the guess, its position counts as measured.
void addSearchedMotion(const InitialGuess& guess, Measurement& measurement);

/// What is seen alike from sweep to sweep - a vehicle ahead, edges drawn by single beams - fits best at standstill. For
/// as long as the speed is unknown: little information is no proof of it, the way is known no better than the fastest.
void inflateAlongTrack(const InitialGuess& guess, const MotionInitialization::Params& params, Measurement& measurement);

}  // namespace fail_aware
