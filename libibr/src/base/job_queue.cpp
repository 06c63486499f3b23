// SPDX-License-Identifier: Apache-2.0
#include "base/job_queue.h"

#include <algorithm>
#include <cassert>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <utility>

namespace ibr {

// State that the queue shares with its threads, and with functions that the executor holds.
struct JobQueue::Control {
  // A function for the executor, made in advance, so that add() allocates nothing.
  struct Ready {
    std::function<void()> call;
    Ticket* ticket = nullptr;  // owned by `call`
  };

  std::mutex mutex;  // guards all members but `executor`
  std::condition_variable added, finished;
  std::vector<Job*> queue;
  std::size_t running = 0;
  bool closed = false;
  std::stop_source stop;

  Executor executor;
  unsigned concurrency = 0;  // maximum of handedOver
  unsigned handedOver = 0;   // functions that the executor holds or calls
  std::vector<Ready> ready;

  void remove(Job& job) {
    queue.erase(std::ranges::find(queue, &job));
    job.state_ = JobState::idle;
  }

  // Runs a job that is not queued, unlocked meanwhile.
  void run(std::unique_lock<std::mutex>& lock, Job& job) {
    job.state_ = JobState::running;
    ++running;
    lock.unlock();
    job.run(stop.get_token());
    lock.lock();
    job.state_ = JobState::idle;
    --running;
    finished.notify_all();
  }

  void runAll(std::unique_lock<std::mutex>& lock) {
    while (!queue.empty()) {
      Job& job = **std::ranges::min_element(queue, {}, [](const Job* queued) { return queued->order_; });
      remove(job);
      run(lock, job);
    }
  }

  void runThread() {
    std::unique_lock lock(mutex);
    while (!closed) {
      runAll(lock);
      added.wait(lock, [&] { return closed || !queue.empty(); });
    }
  }

  // The mutex must be locked. Leaves `next` to the caller if it is not needed.
  void addReady(Ready& next) noexcept {
    if (next.call && !closed && ready.size() < concurrency) ready.push_back(std::move(next));
  }

  void handOver();
};

// Owned by a function of the executor, which counts as handed over until it has been called or destroyed.
struct JobQueue::Ticket {
  explicit Ticket(std::shared_ptr<Control> of) : control(std::move(of)) {}
  Ticket(const Ticket&) = delete;
  Ticket& operator=(const Ticket&) = delete;
  ~Ticket() {
    if (!isHandedOver) return;
    Control::Ready next = makeReady(control);
    const std::lock_guard lock(control->mutex);
    takeBack(next);
  }

  void run() {
    std::unique_lock lock(control->mutex);
    if (!isHandedOver || control->closed) return;
    control->runAll(lock);
    lock.unlock();
    Control::Ready next = makeReady(control);
    lock.lock();
    // Jobs that were added meanwhile: add() hands nothing over as long as this function counts.
    if (!control->closed) control->runAll(lock);
    takeBack(next);
  }

  // The mutex must be locked.
  void takeBack(Control::Ready& next) noexcept {
    if (!std::exchange(isHandedOver, false)) return;  // a copy of the function was called, too
    --control->handedOver;
    control->addReady(next);
  }

  // Returns an empty function if out of memory: then fewer functions are handed over at a time.
  static Control::Ready makeReady(const std::shared_ptr<Control>& control) noexcept try {
    auto ticket = std::make_shared<Ticket>(control);
    Control::Ready made{.ticket = ticket.get()};
    made.call = [ticket = std::move(ticket)] { ticket->run(); };
    return made;
  } catch (const std::exception&) {
    return {};
  }

  std::shared_ptr<Control> control;
  bool isHandedOver = false;
};

void JobQueue::Control::handOver() {
  std::function<void()> call;
  {
    const std::lock_guard lock(mutex);
    if (queue.empty() || handedOver >= concurrency || ready.empty()) return;
    ready.back().ticket->isHandedOver = true;
    call = std::move(ready.back().call);
    ready.pop_back();
    ++handedOver;
  }
  try {
    executor(std::move(call));
  } catch (...) {  // the job stays queued; the next add() hands over again
  }
}

JobQueue::JobQueue(unsigned threads, Executor executor, std::size_t capacity) : control_(std::make_shared<Control>()) {
  Control& control = *control_;
  control.queue.reserve(capacity);
  control.concurrency = threads;
  if (threads == 0) return;
  if (executor) {
    control.executor = std::move(executor);
    control.ready.reserve(threads);
    for (unsigned i = 0; i < threads; ++i) {
      Control::Ready made = Ticket::makeReady(control_);
      control.addReady(made);
    }
    return;
  }
  threads_.reserve(threads);
  try {
    for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([shared = control_] { shared->runThread(); });
  } catch (const std::exception&) {  // fewer threads; without any, jobs run on the calling thread
    control.concurrency = unsigned(threads_.size());
  }
}

JobQueue::~JobQueue() {
  std::vector<Control::Ready> ready;
  {
    const std::lock_guard lock(control_->mutex);
    control_->closed = true;
    for (Job* job : control_->queue) job->state_ = JobState::idle;
    control_->queue.clear();
    ready.swap(control_->ready);
  }
  requestStop();
  control_->added.notify_all();
  for (std::thread& thread : threads_) thread.join();
  {
    std::unique_lock lock(control_->mutex);
    control_->finished.wait(lock, [&] { return control_->running == 0; });
  }
  control_->executor = nullptr;
}

unsigned JobQueue::threads() const noexcept {
  return control_->concurrency;
}

void JobQueue::add(Job& job, std::uint64_t order) {
  {
    std::unique_lock lock(control_->mutex);
    assert(job.state_ == JobState::idle && control_->queue.size() < control_->queue.capacity());
    job.order_ = order;
    if (threads() == 0) return control_->run(lock, job);
    job.state_ = JobState::queued;
    control_->queue.push_back(&job);
  }
  if (control_->executor)
    control_->handOver();
  else
    control_->added.notify_one();
}

bool JobQueue::withdraw(Job& job) {
  const std::lock_guard lock(control_->mutex);
  if (job.state_ != JobState::queued) return false;
  control_->remove(job);
  return true;
}

JobQueue::JobState JobQueue::state(const Job& job) const {
  const std::lock_guard lock(control_->mutex);
  return job.state_;
}

void JobQueue::finish(Job& job) {
  std::unique_lock lock(control_->mutex);
  if (job.state_ == JobState::queued) {
    control_->remove(job);
    control_->run(lock, job);
  }
  control_->finished.wait(lock, [&] { return job.state_ == JobState::idle; });
}

void JobQueue::requestStop() noexcept {
  control_->stop.request_stop();
}

}  // namespace ibr
