#include "core/estimation/sweep_scheduler.hpp"

#include <algorithm>

namespace fail_aware {

void SweepScheduler::setParams(const Params& params) {
  params_ = params;
  may_wait_ = params.queue_size;
}

void SweepScheduler::offer(const Sweep& sweep) {
  waiting_.push_back(sweep);
  if (waiting_.size() > may_wait_) may_wait_ = std::max<std::size_t>(1, may_wait_ - 1);
  while (waiting_.size() > may_wait_) {
    const double set_back_s = waiting_.front().set_back_s;
    waiting_.pop_front();
    waiting_.front().set_back_s = std::max(waiting_.front().set_back_s, set_back_s);
    lose(counts_.overload);
  }
}

void SweepScheduler::refuse(Cause cause) {
  switch (cause) {
    case Cause::kDuplicate: last_refused_ = "duplicate stamp"; return lose(counts_.duplicate);
    case Cause::kReordered: last_refused_ = "stamp out of order"; return lose(counts_.reordered);
    case Cause::kFarAhead: last_refused_ = "stamp far ahead"; return lose(counts_.far_ahead);
    case Cause::kUnusableStamp: last_refused_ = "stamp not usable"; return lose(counts_.unusable_stamp);
    case Cause::kWrongFrame: last_refused_ = "another frame"; return lose(counts_.wrong_frame);
  }
}

std::optional<SweepScheduler::Sweep> SweepScheduler::open(double now_s) {
  if (open_) return std::nullopt;
  if (waiting_.empty()) {
    may_wait_ = params_.queue_size;
    return std::nullopt;
  }
  open_ = waiting_.front();
  waiting_.pop_front();
  opened_s_ = now_s;
  searches_ = false;
  return open_;
}

bool SweepScheduler::isOverdue(double now_s, bool is_at_work) const {
  if (!open_) return false;
  const double open_s = now_s - opened_s_;
  if (open_s < params_.deadline_s) return false;
  if (!is_at_work) return true;
  return searches_ ? open_s >= params_.first_deadline_s : now_s - open_->arrived_s >= params_.late_deadline_s;
}

double SweepScheduler::longest_s() const {
  return std::max(params_.deadline_s, searches_ ? params_.first_deadline_s : params_.late_deadline_s);
}

void SweepScheduler::clear() {
  counts_.reset += waiting_.size() + (open_ ? 1 : 0);
  waiting_.clear();
  open_.reset();
  may_wait_ = params_.queue_size;
  dropped_ = 0;
}

void SweepScheduler::lose(std::size_t& cause) {
  ++cause;
  ++dropped_;
}

}  // namespace fail_aware
