// How a stage has answered lately: in time, late (it is at work, but not done by the deadline), or not at all.
#pragma once

namespace fail_aware {

class AnswerRecord {
 public:
  void inTime() {
    missed_ = 0;
    late_ = false;
  }
  /// An answer to a sweep that was closed already.
  void late() {
    missed_ = 0;
    late_ = true;
  }
  /// A sweep was closed without an answer.
  void miss() { ++missed_; }

  /// Not heard of for so many sweeps in a row.
  bool isSilent(int sweeps) const { return missed_ >= sweeps; }
  /// Since the last sweep was closed, or in it, something was heard.
  bool isAtWork() const { return missed_ == 0; }
  /// What was heard last came too late: more time may help.
  bool isLate() const { return late_; }

 private:
  int missed_ = 0;
  bool late_ = false;
};

}  // namespace fail_aware
