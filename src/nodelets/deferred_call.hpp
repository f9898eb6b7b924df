// A call at the end of a callback queue, after all callbacks that are already in the queue. An overloaded nodelet thus
// receives every waiting message before it decides what to do next. Not thread-safe: one queue, served by one thread.
#pragma once

#include <ros/callback_queue_interface.h>
#include <ros/node_handle.h>

#include <boost/make_shared.hpp>
#include <functional>
#include <utility>

namespace fail_aware {

class DeferredCall {
 public:
  DeferredCall(const ros::NodeHandle& node, std::function<void()> call)
      : queue_(node.getCallbackQueue()), callback_(boost::make_shared<Callback>(std::move(call))) {}
  ~DeferredCall() { queue_->removeByID(reinterpret_cast<std::uint64_t>(this)); }
  DeferredCall(const DeferredCall&) = delete;
  DeferredCall& operator=(const DeferredCall&) = delete;

  /// Adds the call unless it is already in the queue.
  void request() {
    if (callback_->pending) return;
    callback_->pending = true;
    queue_->addCallback(callback_, reinterpret_cast<std::uint64_t>(this));
  }

 private:
  struct Callback : ros::CallbackInterface {
    explicit Callback(std::function<void()> what) : run(std::move(what)) {}
    CallResult call() override {
      pending = false;
      run();
      return Success;
    }
    std::function<void()> run;
    bool pending = false;
  };

  ros::CallbackQueueInterface* queue_;
  boost::shared_ptr<Callback> callback_;
};

}  // namespace fail_aware
