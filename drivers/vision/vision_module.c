/* The part of the module `vision` that is linked into the program. */
#include "drivers/vision/vision_module.h"

static struct iso_module_slot slot = {.name = ISO_VISION_MODULE_NAME,
                                      .size_bytes = sizeof(struct iso_vision_module)};

/* May be called only after iso_face_detector_load. */
static const struct iso_vision_module *module(void)
{
    return (const struct iso_vision_module *)slot.table;
}

int iso_face_detector_load(struct iso_fault *fault)
{
    return iso_module_load(&slot, fault);
}

const char *iso_face_detector_engine(void)
{
    return iso_face_detector_load(NULL) ? "" : module()->engine();
}

const char *iso_face_detector_cascade(void)
{
    return iso_face_detector_load(NULL) ? "" : module()->cascade();
}

int iso_face_detector_new(const char *cascade_path, struct iso_face_detector **out,
                          struct iso_fault *fault)
{
    const int error = iso_face_detector_load(fault);
    return error ? error : module()->create(cascade_path, out, fault);
}

void iso_face_detector_free(struct iso_face_detector *detector)
{
    if (detector) {
        module()->release(detector);
    }
}

int iso_face_detector_find(struct iso_face_detector *detector, const uint8_t *picture, int width_px,
                           int height_px, int min_px, int max_px, struct iso_face_box *out)
{
    return module()->find(detector, picture, width_px, height_px, min_px, max_px, out);
}
