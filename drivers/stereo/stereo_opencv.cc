#include "drivers/stereo/stereo_opencv.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/stereo/opencv_guard.hh"

using iso::guarded;
using iso::wrap;

struct iso_stereo_opencv {
    cv::Size size;
    int border;        /* columns added at the left, in half-size pixels */
    cv::Mat map[2][2]; /* in the form that cv::convertMaps makes */
    cv::Mat half[2], padded[2];
    cv::Mat disparity; /* of the padded image, in 1/16 pixel */
    cv::Ptr<cv::StereoSGBM> matcher;
};

namespace
{

const int block = 5; /* width of the matched windows, in half-size pixels */

int multiple_of_16(int n)
{
    return (n + 15) / 16 * 16;
}

void set_up(iso_stereo_opencv &s, const iso_stereo_opencv_options &o)
{
    cv::setNumThreads(0);
    s.size = cv::Size(o.width_px, o.height_px);
    for (int eye = 0; eye < 2; eye++) {
        cv::convertMaps(wrap(s.size, CV_32FC1, o.map_x_px[eye]),
                        wrap(s.size, CV_32FC1, o.map_y_px[eye]), s.map[eye][0], s.map[eye][1],
                        CV_16SC2);
    }
    int from = o.disparity_min_px / 2;
    int count = multiple_of_16((o.disparity_max_px + 1) / 2 - from + 1);
    /* OpenCV leaves out the columns whose range is not completely in the right image. */
    s.border = from + count;
    s.matcher = cv::StereoSGBM::create(from, count, block, 8 * block * block, 32 * block * block,
                                       /*disp12MaxDiff*/ 1, /*preFilterCap*/ 31,
                                       /*uniquenessRatio*/ 10, /*speckleWindowSize*/ 200,
                                       /*speckleRange*/ 2, cv::StereoSGBM::MODE_SGBM);
}

void halve(iso_stereo_opencv &s, int eye, const uint8_t *image)
{
    cv::resize(wrap(s.size, CV_8UC1, image), s.half[eye], s.size / 2, 0, 0, cv::INTER_AREA);
    cv::copyMakeBorder(s.half[eye], s.padded[eye], 0, 0, s.border, 0, cv::BORDER_REPLICATE);
}

} // namespace

int iso_stereo_opencv_new(const struct iso_stereo_opencv_options *options,
                          struct iso_stereo_opencv **out)
{
    int range = options->disparity_max_px - options->disparity_min_px;
    if (options->width_px < 64 || options->height_px < 64 || options->width_px % 2 ||
        options->height_px % 2 || options->disparity_min_px < 0 || range < 1 || range > 1024) {
        return -EINVAL;
    }
    iso_stereo_opencv *stereo = nullptr;
    int error = guarded([&] {
        stereo = new iso_stereo_opencv;
        set_up(*stereo, *options);
    });
    if (error) {
        delete stereo;
        return error;
    }
    *out = stereo;
    return 0;
}

void iso_stereo_opencv_free(struct iso_stereo_opencv *stereo)
{
    delete stereo;
}

int iso_stereo_opencv_rectify(struct iso_stereo_opencv *stereo, int eye, const uint8_t *image,
                              uint8_t *rectified)
{
    return guarded([&] {
        cv::Mat to = wrap(stereo->size, CV_8UC1, rectified);
        cv::remap(wrap(stereo->size, CV_8UC1, image), to, stereo->map[eye][0], stereo->map[eye][1],
                  cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(0));
    });
}

int iso_stereo_opencv_match(struct iso_stereo_opencv *stereo, const uint8_t *left,
                            const uint8_t *right, float *disparity_px)
{
    return guarded([&] {
        iso_stereo_opencv &s = *stereo;
        halve(s, 0, left);
        halve(s, 1, right);
        s.matcher->compute(s.padded[0], s.padded[1], s.disparity);
        cv::Mat out = wrap(s.size / 2, CV_32FC1, disparity_px);
        /* 16 counts per half-size pixel are 8 per pixel of the whole image. The value for "none" is
         * below the range. */
        s.disparity.colRange(s.border, s.disparity.cols).convertTo(out, CV_32FC1, 1.0 / 8.0);
        float least = 2.0f * (float)s.matcher->getMinDisparity();
        cv::threshold(out, out, (double)least - 0.01, 0.0, cv::THRESH_TOZERO);
    });
}
