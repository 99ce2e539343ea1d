/* Helps C++ code that calls OpenCV to be called from C. Internal to drivers/stereo. */
#ifndef ISO_DRIVERS_STEREO_OPENCV_GUARD_HH
#define ISO_DRIVERS_STEREO_OPENCV_GUARD_HH

#include <cerrno>
#include <new>

#include <opencv2/core.hpp>

namespace iso
{

/* Runs a function and converts an exception into a negative errno; 0 without an exception. */
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

/* Makes a matrix that uses the caller's samples without copying them. If they are const, the caller
 * must not let OpenCV write to the matrix. */
inline cv::Mat wrap(const cv::Size &size, int type, const void *samples)
{
    return cv::Mat(size, type, const_cast<void *>(samples));
}

} // namespace iso

#endif
