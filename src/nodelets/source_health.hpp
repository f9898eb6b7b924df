// How a source has answered recently: in time, late (at work, but after the deadline), in vain (later than the longest
// time that a sweep stays open), or not at all.
#pragma once

namespace fail_aware {

class SourceHealth {
 public:
  void inTime() {
    missed_ = in_vain_ = 0;
    late_ = false;
  }
  /// An answer to a sweep that was already closed.
  void late(bool in_vain) {
    missed_ = 0;
    late_ = true;
    in_vain_ = in_vain ? in_vain_ + 1 : 0;
  }
  /// A sweep was closed without an answer.
  void miss() { ++missed_; }

  /// No answer for this many consecutive sweeps.
  bool isSilent(int sweeps) const { return missed_ >= sweeps; }
  /// This many consecutive answers were in vain: waiting for the source gains nothing.
  bool isTooLate(int sweeps) const { return in_vain_ >= sweeps; }
  /// The source answered the last closed sweep, or has answered since.
  bool isAtWork() const { return missed_ == 0; }
  /// The last answer was late: more time may help.
  bool isLate() const { return late_; }

 private:
  int missed_ = 0;
  int in_vain_ = 0;
  bool late_ = false;
};

}  // namespace fail_aware
