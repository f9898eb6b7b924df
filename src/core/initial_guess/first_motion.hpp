// Additions to the first measurements of a drive, beyond the registered surfaces (motion_initialization.hpp). Not in
// the paper.
//
// These functions leave a measurement without a pose unchanged.
#pragma once

#include "core/initial_guess/initial_guess.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

/// Adds the position of the initial guess as measured, if the search for the first motion found it. The search uses
/// points above the ground; surfaces alone may hold too little information.
void addSearchedMotion(const InitialGuess& guess, Measurement& measurement);

/// Near the first sweep of a drive that began at standstill, and with little information: adds the distance of the
/// guess along the track as measured. As far as the measurement contradicts it, the measurement is not believed. Where
/// no distance was found, the covariance holds what the vehicle may have gone since one was.
void addDriveOff(const InitialGuess& guess, const MotionInitialization::Params& params, Measurement& measurement);

/// Inflates the covariance along the track while the speed is unknown. Objects that look alike in every sweep (a vehicle
/// ahead, edges drawn by single beams) fit best at standstill: with little information the sigma of the distance is that
/// of the largest speed. Near the start drive_off.hpp decides, but a standstill needs some information all the same.
void inflateAlongTrack(const InitialGuess& guess, const MotionInitialization::Params& params, Measurement& measurement);

}  // namespace fail_aware
