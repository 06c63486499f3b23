// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/picture_writer.h"

#include <utility>

#include "ibr/error.h"

namespace ibr::app {
namespace {

PictureResult resultOf(const PictureJob& job) {
  PictureResult result{.files = {}, .error = {}, .required = job.required};
  try {
    result.files = job.write();
  } catch (const Error&) {
    result.error = std::current_exception();
  } catch (const std::exception& e) {
    result.error = std::make_exception_ptr(Error(ErrorCode::io, job.name + ": " + e.what()));
  }
  return result;
}

}  // namespace

PictureWriter::PictureWriter(std::function<void()> onResult, std::size_t maxQueued)
    : onResult_(std::move(onResult)), maxQueued_(maxQueued), thread_([this] { run(); }) {}

PictureWriter::~PictureWriter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PictureWriter::add(PictureJob job) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return queue_.size() < maxQueued_; });
    queue_.push_back(std::move(job));
  }
  changed_.notify_all();
}

std::vector<PictureResult> PictureWriter::takeResults() {
  const std::lock_guard lock(mutex_);
  hasResults_ = false;
  return std::exchange(results_, {});
}

std::vector<PictureResult> PictureWriter::waitForResults() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !results_.empty() || (queue_.empty() && !running_); });
  }
  return takeResults();
}

std::vector<PictureResult> PictureWriter::finish() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return queue_.empty() && !running_; });
  }
  return takeResults();
}

void PictureWriter::run() {
  for (;;) {
    PictureJob job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !queue_.empty() || ending_; });
      if (queue_.empty()) return;
      job = std::move(queue_.front());
      queue_.pop_front();
      running_ = true;
    }
    changed_.notify_all();
    PictureResult result = resultOf(job);
    job = {};  // releases the picture before the result is seen
    {
      const std::lock_guard lock(mutex_);
      results_.push_back(std::move(result));
      hasResults_ = true;
      running_ = false;
    }
    changed_.notify_all();
    if (onResult_) onResult_();
  }
}

}  // namespace ibr::app
