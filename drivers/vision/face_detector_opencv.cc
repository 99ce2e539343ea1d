/* The detector, made with OpenCV. No exception leaves this file. */
extern "C" {
#include "drivers/vision/face_detector.h"
}

#include <cerrno>
#include <cstring>
#include <new>
#include <unistd.h>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>

/* The ratio of the sizes that are tried one after the other, and the number of windows that must
 * agree. */
static const double scale_step = 1.1;
static const int votes_min = 2;

struct iso_face_detector {
    cv::CascadeClassifier cascade;
};

const char *iso_face_detector_engine(void)
{
    return "OpenCV " CV_VERSION;
}

const char *iso_face_detector_cascade(void)
{
    return ISOTHERM_CASCADE;
}

int iso_face_detector_new(const char *cascade_path, struct iso_face_detector **out,
                          struct iso_fault *fault)
{
    if (access(cascade_path, R_OK) != 0) {
        const int error = -errno;
        return iso_fault_set(fault, error, "%s: %s", cascade_path, std::strerror(-error));
    }
    struct iso_face_detector *detector = new (std::nothrow) iso_face_detector;
    if (!detector) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", cascade_path);
    }
    bool loaded = false;
    try {
        cv::setNumThreads(1); /* the search runs in the thread of the caller */
        loaded = detector->cascade.load(cascade_path);
    } catch (const std::exception &) {
        loaded = false;
    }
    if (!loaded) {
        delete detector;
        return iso_fault_set_code(fault, ISO_FAULT_MODEL_DAMAGED, -EBADMSG,
                                  "%s: not a cascade that OpenCV can read", cascade_path);
    }
    *out = detector;
    return 0;
}

void iso_face_detector_free(struct iso_face_detector *detector)
{
    delete detector;
}

static struct iso_face_box box_of(const cv::Rect &square, int votes)
{
    const double half = 0.5 * (square.width - 1);
    return {square.x + half, square.y + half, (double)square.width, votes};
}

int iso_face_detector_find(struct iso_face_detector *detector, const uint8_t *picture, int width_px,
                           int height_px, int min_px, int max_px, struct iso_face_box *out)
{
    const int most_px = 8192;
    if (width_px < 1 || width_px > most_px || height_px < 1 || height_px > most_px || min_px < 1 ||
        min_px > max_px) {
        return -EINVAL;
    }
    try {
        /* OpenCV has no matrix with constant samples, but it only reads these. */
        const cv::Mat grey(height_px, width_px, CV_8UC1, const_cast<uint8_t *>(picture));
        std::vector<cv::Rect> squares;
        std::vector<int> votes;
        struct iso_face_box best = {0.0, 0.0, 0.0, 0};
        detector->cascade.detectMultiScale(grey, squares, votes, scale_step, votes_min, 0,
                                           cv::Size(min_px, min_px), cv::Size(max_px, max_px));
        for (size_t i = 0; i < squares.size(); i++) {
            if (votes[i] > best.votes) {
                best = box_of(squares[i], votes[i]);
            }
        }
        *out = best;
        return 0;
    } catch (const std::bad_alloc &) {
        return -ENOMEM;
    } catch (const std::exception &) {
        return -EIO;
    }
}
