#include "drivers/sensor/libcamera/libcamera_eye.hh"

#include <cerrno>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

namespace iso
{

using namespace libcamera;

/* The grey formats in the order of preference. */
static const PixelFormat wanted[] = {formats::R8, formats::R12, formats::R10, formats::YUYV};

Eye::Eye() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC | EFD_SEMAPHORE))
{
}

Eye::~Eye()
{
    release();
    if (fd_ >= 0) {
        close(fd_);
    }
}

int Eye::open(std::shared_ptr<Camera> camera, const iso_libcamera_options &options)
{
    int error = camera->acquire();
    if (error) {
        return error == -EBUSY ? -EBUSY : -EIO;
    }
    camera_ = std::move(camera);
    error = configure(options);
    if (!error) {
        error = allocate();
    }
    if (!error && options.fps > 0 && camera_->controls().count(&controls::FrameDurationLimits)) {
        int64_t period_us = 1000000 / options.fps;
        controls_.set(controls::FrameDurationLimits,
                      Span<const int64_t, 2>({period_us, period_us}));
    }
    camera_->bufferCompleted.connect(this, &Eye::filled);
    camera_->requestCompleted.connect(this, &Eye::completed);
    camera_->disconnected.connect(this, &Eye::disconnected);
    return error;
}

int Eye::configure(const iso_libcamera_options &options)
{
    for (const PixelFormat &format : wanted) {
        config_ = camera_->generateConfiguration({StreamRole::Viewfinder});
        if (!config_ || config_->empty()) {
            return -EINVAL;
        }
        StreamConfiguration &stream = config_->at(0);
        stream.pixelFormat = format;
        stream.size = Size((unsigned)options.width_px, (unsigned)options.height_px);
        stream.bufferCount = 4;
        Size size = stream.size;
        if (config_->validate() != CameraConfiguration::Invalid && stream.pixelFormat == format &&
            stream.size == size) {
            return camera_->configure(config_.get()) ? -EIO : 0;
        }
    }
    return -EINVAL;
}

/* Maps a buffer and makes a request for it. */
int Eye::add_buffer(Stream *stream, FrameBuffer *buffer)
{
    const FrameBuffer::Plane &plane = buffer->planes()[0];
    mapping map;
    map.first = plane.offset;
    map.length = plane.offset + plane.length;
    void *at = mmap(nullptr, map.length, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
    if (at == MAP_FAILED) {
        return -ENOMEM;
    }
    map.at = (uint8_t *)at;
    maps_[buffer] = map;
    auto request = camera_->createRequest(slots_.size());
    if (!request || request->addBuffer(stream, buffer)) {
        return -ENOMEM;
    }
    slots_.push_back(slot{std::move(request), buffer});
    return 0;
}

int Eye::allocate()
{
    Stream *stream = config_->at(0).stream();
    allocator_ = std::make_unique<FrameBufferAllocator>(camera_);
    if (allocator_->allocate(stream) < 0) {
        return -ENOMEM;
    }
    for (const auto &buffer : allocator_->buffers(stream)) {
        const int error = add_buffer(stream, buffer.get());
        if (error) {
            return error;
        }
    }
    return 0;
}

int Eye::start()
{
    if (lost_) {
        return -ENODEV;
    }
    if (camera_->start(&controls_)) {
        return explain();
    }
    streaming_ = true;
    for (slot &each : slots_) {
        if (queue(each)) {
            stop();
            return -EIO;
        }
    }
    return 0;
}

/* Finds out why the camera does not start. If it was just unplugged, libcamera reports this only a
 * little later. */
int Eye::explain()
{
    struct pollfd told = {fd_, POLLIN, 0};
    (void)poll(&told, 1, 900);
    std::lock_guard<std::mutex> lock(mutex_);
    return lost_ ? -ENODEV : -EIO;
}

int Eye::stop()
{
    uint64_t one;
    int error = streaming_ && camera_->stop() ? -EIO : 0;
    streaming_ = false;
    std::lock_guard<std::mutex> lock(mutex_);
    filled_.clear();
    taken_ = nullptr;
    broken_ = false;
    while (read(fd_, &one, sizeof one) == (ssize_t)sizeof one) {
    }
    return lost_ ? -ENODEV : error;
}

int Eye::take(iso_libcamera_picture *out)
{
    uint64_t one;
    {
        std::lock_guard<std::mutex> lock(mutex_);
        if (lost_ || broken_) {
            return lost_ ? -ENODEV : -EIO;
        }
        if (filled_.empty()) {
            return -EAGAIN;
        }
        taken_ = filled_.front();
        filled_.pop_front();
    }
    (void)!read(fd_, &one, sizeof one);
    const FrameMetadata &metadata = taken_->buffer->metadata();
    const StreamConfiguration &stream = config_->at(0);
    if (metadata.status != FrameMetadata::FrameSuccess) {
        int error = give_back();
        return error ? error : -EBADMSG;
    }
    const mapping &map = maps_.at(taken_->buffer);
    *out = iso_libcamera_picture{map.at + map.first,     metadata.planes()[0].bytesused,
                                 stream.stride,          stream.pixelFormat.fourcc(),
                                 (int)stream.size.width, (int)stream.size.height,
                                 metadata.sequence,      (int64_t)metadata.timestamp};
    return 0;
}

int Eye::give_back()
{
    slot *returned = taken_;
    taken_ = nullptr;
    if (!returned || !let_go(*returned, &slot::given_back)) {
        return 0;
    }
    if (queue(*returned)) {
        return lost_ ? -ENODEV : -EIO;
    }
    return 0;
}

/* Queues a request in libcamera. Both threads may call this. */
int Eye::queue(slot &each)
{
    {
        std::lock_guard<std::mutex> lock(mutex_);
        each.given_back = each.done = false;
    }
    each.request->reuse(Request::ReuseBuffers);
    return camera_->queueRequest(each.request.get());
}

/* Notes that one side has finished with a request. Returns true to the side that finishes last. */
bool Eye::let_go(slot &each, bool slot::*side)
{
    std::lock_guard<std::mutex> lock(mutex_);
    each.*side = true;
    return each.given_back && each.done;
}

slot &Eye::slot_of(const Request *request)
{
    return slots_[request->cookie()];
}

void Eye::filled(Request *request, FrameBuffer *buffer)
{
    const uint64_t one = 1;
    if (buffer->metadata().status == FrameMetadata::FrameCancelled) {
        return;
        /* The camera is being stopped. */
    }
    std::lock_guard<std::mutex> lock(mutex_);
    filled_.push_back(&slot_of(request));
    (void)!write(fd_, &one, sizeof one);
}

/* If a request cannot be queued again, the next take reports it, except when the camera is being
 * stopped. */
void Eye::completed(Request *request)
{
    const uint64_t one = 1;
    slot &each = slot_of(request);
    if (request->status() == Request::RequestCancelled || !let_go(each, &slot::done) ||
        !queue(each)) {
        return;
    }
    std::lock_guard<std::mutex> lock(mutex_);
    broken_ = true;
    (void)!write(fd_, &one, sizeof one);
}

void Eye::disconnected()
{
    const uint64_t one = 1;
    std::lock_guard<std::mutex> lock(mutex_);
    lost_ = true;
    (void)!write(fd_, &one, sizeof one);
}

void Eye::release()
{
    if (!camera_) {
        return;
    }
    (void)stop();
    camera_->bufferCompleted.disconnect(this);
    camera_->requestCompleted.disconnect(this);
    camera_->disconnected.disconnect(this);
    slots_.clear();
    for (auto &entry : maps_) {
        munmap(entry.second.at, entry.second.length);
    }
    maps_.clear();
    allocator_.reset();
    (void)camera_->release();
    camera_.reset();
}

} // namespace iso
