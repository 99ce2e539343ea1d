#include "drivers/sensor/libcamera/libcamera_pair.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <libcamera/libcamera.h>
#include <libcamera/property_ids.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

namespace
{

using namespace libcamera;

/* The grey formats, the best first. */
const PixelFormat wanted[] = {formats::R8, formats::R12, formats::R10, formats::YUYV};

std::atomic_flag in_use = ATOMIC_FLAG_INIT;     /* there is a manager */
std::atomic<const CameraManager *> of_the_pair; /* that of the open pair */

struct mapping {
    uint8_t *at = nullptr;
    size_t length = 0, first = 0; /* of the map; from its begin to the picture */
};

/* A picture is handed out when libcamera says that its buffer is filled, not when it says that the
 * request around it is done: requests are done in the order in which they were made, so that one
 * whose buffer waits for another picture (the kernel had to give up its first one) would hold back
 * the later ones and then come before them. Buffers come as they were filled. A request goes to
 * libcamera again when both are through with it: `given_back` and `done`. */
struct slot {
    std::unique_ptr<Request> request;
    FrameBuffer *buffer = nullptr;
    bool given_back = false; /* nobody looks at the picture any more */
    bool done = false;       /* libcamera has let go of the request */
};

class Eye
{
  public:
    Eye() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC | EFD_SEMAPHORE))
    {
    }

    ~Eye()
    {
        release();
        if (fd_ >= 0) {
            close(fd_);
        }
    }

    Eye(const Eye &) = delete;
    Eye &operator=(const Eye &) = delete;

    int open(std::shared_ptr<Camera> camera, const iso_libcamera_options &options)
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
        if (!error && options.fps > 0 &&
            camera_->controls().count(&controls::FrameDurationLimits)) {
            int64_t period_us = 1000000 / options.fps;
            controls_.set(controls::FrameDurationLimits,
                          Span<const int64_t, 2>({period_us, period_us}));
        }
        camera_->bufferCompleted.connect(this, &Eye::filled);
        camera_->requestCompleted.connect(this, &Eye::completed);
        camera_->disconnected.connect(this, &Eye::disconnected);
        return error;
    }

    int start()
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

    int stop()
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

    int take(iso_libcamera_picture *out)
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

    int give_back()
    {
        slot *returned = taken_;
        taken_ = nullptr;
        if (!returned || !let_go(*returned, &slot::given_back)) {
            return 0;
        }
        return queue(*returned) ? (lost_ ? -ENODEV : -EIO) : 0;
    }

    int fd() const
    {
        return fd_;
    }

  private:
    /* A camera that was just pulled out does not start, and libcamera hears of it a little later.
     */
    int explain()
    {
        struct pollfd told = {fd_, POLLIN, 0};
        (void)poll(&told, 1, 900);
        std::lock_guard<std::mutex> lock(mutex_);
        return lost_ ? -ENODEV : -EIO;
    }

    /* Hands a request to libcamera; either thread. */
    int queue(slot &each)
    {
        {
            std::lock_guard<std::mutex> lock(mutex_);
            each.given_back = each.done = false;
        }
        each.request->reuse(Request::ReuseBuffers);
        return camera_->queueRequest(each.request.get());
    }

    /* Notes that one side is through with a request: whether both are now, which one of them only
     * is told. */
    bool let_go(slot &each, bool slot::*side)
    {
        std::lock_guard<std::mutex> lock(mutex_);
        each.*side = true;
        return each.given_back && each.done;
    }

    slot &slot_of(const Request *request)
    {
        return slots_[request->cookie()];
    }

    int configure(const iso_libcamera_options &options)
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
            if (config_->validate() != CameraConfiguration::Invalid &&
                stream.pixelFormat == format && stream.size == size) {
                return camera_->configure(config_.get()) ? -EIO : 0;
            }
        }
        return -EINVAL;
    }

    int allocate()
    {
        Stream *stream = config_->at(0).stream();
        allocator_ = std::make_unique<FrameBufferAllocator>(camera_);
        if (allocator_->allocate(stream) < 0) {
            return -ENOMEM;
        }
        for (const auto &buffer : allocator_->buffers(stream)) {
            const FrameBuffer::Plane &plane = buffer->planes()[0];
            mapping map;
            map.first = plane.offset;
            map.length = plane.offset + plane.length;
            void *at = mmap(nullptr, map.length, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
            if (at == MAP_FAILED) {
                return -ENOMEM;
            }
            map.at = (uint8_t *)at;
            maps_[buffer.get()] = map;
            auto request = camera_->createRequest(slots_.size());
            if (!request || request->addBuffer(stream, buffer.get())) {
                return -ENOMEM;
            }
            slots_.push_back(slot{std::move(request), buffer.get()});
        }
        return 0;
    }

    /* In libcamera's thread. */
    void filled(Request *request, FrameBuffer *buffer)
    {
        const uint64_t one = 1;
        if (buffer->metadata().status == FrameMetadata::FrameCancelled) {
            return; /* it is being stopped */
        }
        std::lock_guard<std::mutex> lock(mutex_);
        filled_.push_back(&slot_of(request));
        (void)!write(fd_, &one, sizeof one);
    }

    /* In libcamera's thread. One that cannot be queued again is noticed by the next take, unless it
     * is that the camera is being stopped. */
    void completed(Request *request)
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

    /* In libcamera's thread. */
    void disconnected()
    {
        const uint64_t one = 1;
        std::lock_guard<std::mutex> lock(mutex_);
        lost_ = true;
        (void)!write(fd_, &one, sizeof one);
    }

    void release()
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

    std::shared_ptr<Camera> camera_;
    std::unique_ptr<CameraConfiguration> config_;
    std::unique_ptr<FrameBufferAllocator> allocator_;
    std::vector<slot> slots_; /* the requests' cookies are indices */
    std::map<const FrameBuffer *, mapping> maps_;
    ControlList controls_;
    std::mutex mutex_;          /* of those that follow */
    std::deque<slot *> filled_; /* oldest first */
    bool lost_ = false, broken_ = false;
    slot *taken_ = nullptr;
    bool streaming_ = false;
    int fd_;
};

void tell_all(const CameraManager &manager, void (*tell)(const char *, const char *, void *),
              void *context)
{
    for (const auto &camera : manager.cameras()) {
        const auto model = camera->properties().get(properties::Model);
        tell(camera->id().c_str(), model ? model->c_str() : "", context);
    }
}

std::string list(const CameraManager &manager)
{
    std::string names;
    for (const auto &camera : manager.cameras()) {
        names += (names.empty() ? "" : ", ") + camera->id();
    }
    return names.empty() ? "none" : names;
}

} // namespace

struct iso_libcamera_pair {
    CameraManager manager;
    Eye eyes[2]; /* go before the manager */
};

namespace
{

int open_pair(iso_libcamera_pair &pair, const iso_libcamera_options &options, char *text)
{
    if (pair.manager.start()) {
        std::snprintf(text, ISO_LIBCAMERA_TEXT, "its manager does not start");
        return -EIO;
    }
    for (int i = 0; i < 2; i++) {
        std::shared_ptr<Camera> camera = pair.manager.get(options.ids[i]);
        if (!camera) {
            std::snprintf(text, ISO_LIBCAMERA_TEXT, "no camera '%.80s'; there are: %.80s",
                          options.ids[i], list(pair.manager).c_str());
            return -ENODEV;
        }
        int error = pair.eyes[i].open(camera, options);
        if (error) {
            std::snprintf(text, ISO_LIBCAMERA_TEXT, "camera '%.80s' %s", options.ids[i],
                          error == -EBUSY    ? "is in use"
                          : error == -EINVAL ? "gives no grey pictures of this size"
                                             : "cannot be set up");
            return error;
        }
    }
    return 0;
}

} // namespace

int iso_libcamera_pair_open(const struct iso_libcamera_options *options,
                            struct iso_libcamera_pair **out, char text[ISO_LIBCAMERA_TEXT])
{
    iso_libcamera_pair *pair = nullptr;
    int error = -EIO;
    std::snprintf(text, ISO_LIBCAMERA_TEXT, "cannot be used");
    if (in_use.test_and_set()) {
        std::snprintf(text, ISO_LIBCAMERA_TEXT, "is in use by another sensor of this process");
        return -EBUSY;
    }
    try {
        pair = new iso_libcamera_pair;
        error = open_pair(*pair, *options, text);
    } catch (const std::bad_alloc &) {
        error = -ENOMEM;
    } catch (...) {
        error = -EIO;
    }
    if (error) {
        delete pair;
        in_use.clear();
        return error;
    }
    of_the_pair = &pair->manager;
    *out = pair;
    return 0;
}

void iso_libcamera_pair_close(struct iso_libcamera_pair *pair)
{
    if (pair) {
        of_the_pair = nullptr;
        delete pair;
        in_use.clear();
    }
}

int iso_libcamera_list(void (*tell)(const char *id, const char *model, void *context),
                       void *context)
{
    const CameraManager *manager = of_the_pair;
    if (!manager && in_use.test_and_set()) {
        return -EBUSY;
    }
    int error = 0;
    try {
        if (manager) {
            tell_all(*manager, tell, context);
        } else {
            CameraManager own;
            error = own.start() ? -EIO : 0;
            tell_all(own, tell, context);
        }
    } catch (const std::bad_alloc &) {
        error = -ENOMEM;
    } catch (...) {
        error = -EIO;
    }
    if (!manager) {
        in_use.clear();
    }
    return error;
}

int iso_libcamera_start(struct iso_libcamera_pair *pair, int camera)
{
    return pair->eyes[camera].start();
}

int iso_libcamera_stop(struct iso_libcamera_pair *pair, int camera)
{
    return pair->eyes[camera].stop();
}

int iso_libcamera_take(struct iso_libcamera_pair *pair, int camera,
                       struct iso_libcamera_picture *out)
{
    return pair->eyes[camera].take(out);
}

int iso_libcamera_give_back(struct iso_libcamera_pair *pair, int camera)
{
    return pair->eyes[camera].give_back();
}

int iso_libcamera_fd(const struct iso_libcamera_pair *pair, int camera)
{
    return pair->eyes[camera].fd();
}
