/* What stands between OpenCV and C. Internal to drivers/stereo. */
#ifndef ISO_DRIVERS_STEREO_OPENCV_GUARD_HH
#define ISO_DRIVERS_STEREO_OPENCV_GUARD_HH

#include <cerrno>
#include <new>

#include <opencv2/core.hpp>

namespace iso
{

/* Runs a body and turns what it throws into an errno. */
template <typename Body> int guarded(Body body)
{
    try {
        body();
        return 0;
    } catch (const std::bad_alloc &) {
        return -ENOMEM;
    } catch (const cv::Exception &e) {
        return e.code == cv::Error::StsNoMem ? -ENOMEM : -EIO;
    } catch (...) {
        return -EIO;
    }
}

/* A matrix over samples that stay where they are and are not written to unless they were not const
 * to begin with. */
inline cv::Mat wrap(const cv::Size &size, int type, const void *samples)
{
    return cv::Mat(size, type, const_cast<void *>(samples));
}

} // namespace iso

#endif
