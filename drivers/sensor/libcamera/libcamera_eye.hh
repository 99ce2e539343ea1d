/* One camera through libcamera: a queue of grey pictures behind a lock. libcamera's thread fills
 * it; one other thread calls the public functions. C++, for libcamera_pair.cc. */
#ifndef ISO_DRIVERS_SENSOR_LIBCAMERA_LIBCAMERA_EYE_HH
#define ISO_DRIVERS_SENSOR_LIBCAMERA_LIBCAMERA_EYE_HH

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include <libcamera/libcamera.h>

#include "drivers/sensor/libcamera/libcamera_pair.h"

namespace iso
{

struct mapping {
    uint8_t *at = nullptr;
    size_t length = 0, first = 0; /* of the map; offset of the picture in it */
};

/* A picture is handed out when libcamera reports its buffer as filled, not when it reports the
 * request as complete. Requests complete in the order in which they were made. If the kernel
 * dropped the first picture of a request, its buffer waits for another one; this request would
 * delay the later ones, and its picture would come before theirs. Buffers come in the order in
 * which they were filled. A request is queued again when both the caller and libcamera have
 * finished with it: `given_back` and `done`. */
struct slot {
    std::unique_ptr<libcamera::Request> request;
    libcamera::FrameBuffer *buffer = nullptr;
    bool given_back = false; /* the caller no longer reads the picture */
    bool done = false;       /* libcamera no longer uses the request */
};

/* The functions return 0 or a negative errno, as libcamera_pair.h says. */
class Eye
{
  public:
    Eye();
    ~Eye();
    Eye(const Eye &) = delete;
    Eye &operator=(const Eye &) = delete;

    /* Acquires the camera, sets it up and maps its buffers. */
    int open(std::shared_ptr<libcamera::Camera> camera, const iso_libcamera_options &options);
    int start();
    int stop();

    /* Hands out the oldest picture, until give_back. */
    int take(iso_libcamera_picture *out);
    int give_back();

    /* A descriptor that is readable when there is a picture or a fault. */
    int fd() const
    {
        return fd_;
    }

  private:
    int configure(const iso_libcamera_options &options);
    int allocate();
    int add_buffer(libcamera::Stream *stream, libcamera::FrameBuffer *buffer);
    int explain();
    int queue(slot &each);
    bool let_go(slot &each, bool slot::*side);
    slot &slot_of(const libcamera::Request *request);
    void release();

    /* In libcamera's thread. */
    void filled(libcamera::Request *request, libcamera::FrameBuffer *buffer);
    void completed(libcamera::Request *request);
    void disconnected();

    std::shared_ptr<libcamera::Camera> camera_;
    std::unique_ptr<libcamera::CameraConfiguration> config_;
    std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
    std::vector<slot> slots_; /* the requests' cookies are indices */
    std::map<const libcamera::FrameBuffer *, mapping> maps_;
    libcamera::ControlList controls_;
    std::mutex mutex_;          /* protects filled_, broken_ and the flags of the slots */
    std::deque<slot *> filled_; /* oldest first */
    bool broken_ = false;
    std::atomic<bool> lost_{false}; /* the camera is unplugged; set by the thread of libcamera */
    slot *taken_ = nullptr;
    bool streaming_ = false;
    int fd_;
};

} // namespace iso

#endif
