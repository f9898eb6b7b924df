// How a stage has answered lately: in time, late (it is at work, but not done by the deadline), in vain (late beyond
// what a sweep would have waited for it at most), or not at all.
#pragma once

namespace fail_aware {

class SourceHealth {
 public:
  void inTime() {
    missed_ = in_vain_ = 0;
    late_ = false;
  }
  /// An answer to a sweep that was closed already.
  void late(bool in_vain) {
    missed_ = 0;
    late_ = true;
    in_vain_ = in_vain ? in_vain_ + 1 : 0;
  }
  /// A sweep was closed without an answer.
  void miss() { ++missed_; }

  /// Not heard of for so many sweeps in a row.
  bool isSilent(int sweeps) const { return missed_ >= sweeps; }
  /// So many answers in a row were in vain: waiting for it costs time and gains nothing.
  bool isTooLate(int sweeps) const { return in_vain_ >= sweeps; }
  /// Since the last sweep was closed, or in it, something was heard.
  bool isAtWork() const { return missed_ == 0; }
  /// What was heard last came too late: more time may help.
  bool isLate() const { return late_; }

 private:
  int missed_ = 0;
  int in_vain_ = 0;
  bool late_ = false;
};

}  // namespace fail_aware
