#include "drivers/sensor/libcamera/libcamera_pair.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>

#include <libcamera/libcamera.h>
#include <libcamera/property_ids.h>

#include "drivers/sensor/libcamera/libcamera_eye.hh"

namespace
{

using namespace libcamera;

std::atomic_flag in_use = ATOMIC_FLAG_INIT;     /* a manager exists */
std::atomic<const CameraManager *> of_the_pair; /* the manager of the open pair */

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
    iso::Eye eyes[2]; /* destroyed before the manager */
};

namespace
{

const char *failure_of(int error)
{
    switch (error) {
    case -EBUSY:
        return "is in use";
    case -EINVAL:
        return "delivers no grey pictures of this size";
    default:
        return "cannot be set up";
    }
}

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
                          failure_of(error));
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
