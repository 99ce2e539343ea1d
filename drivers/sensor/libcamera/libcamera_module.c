/* The part of the module `libcamera` that is linked into the program. */
#include "drivers/sensor/libcamera/libcamera_module.h"

#include <stdio.h>

static struct iso_module_slot slot = {.name = ISO_LIBCAMERA_MODULE_NAME,
                                      .size_bytes = sizeof(struct iso_libcamera_module)};

/* May be called only after iso_libcamera_module_load. */
static const struct iso_libcamera_module *module(void)
{
    return (const struct iso_libcamera_module *)slot.table;
}

int iso_libcamera_module_load(struct iso_fault *fault)
{
    return iso_module_load(&slot, fault);
}

int iso_libcamera_pair_open(const struct iso_libcamera_options *options,
                            struct iso_libcamera_pair **out, char text[ISO_LIBCAMERA_TEXT])
{
    struct iso_fault fault;
    const int error = iso_libcamera_module_load(&fault);
    if (error) {
        (void)snprintf(text, ISO_LIBCAMERA_TEXT, "%.*s", ISO_LIBCAMERA_TEXT - 1, fault.text);
        return error;
    }
    return module()->open(options, out, text);
}

void iso_libcamera_pair_close(struct iso_libcamera_pair *pair)
{
    if (pair) {
        module()->close(pair);
    }
}

int iso_libcamera_list(void (*tell)(const char *id, const char *model, void *context),
                       void *context)
{
    const int error = iso_libcamera_module_load(NULL);
    return error ? error : module()->list(tell, context);
}

int iso_libcamera_start(struct iso_libcamera_pair *pair, int camera)
{
    return module()->start(pair, camera);
}

int iso_libcamera_stop(struct iso_libcamera_pair *pair, int camera)
{
    return module()->stop(pair, camera);
}

int iso_libcamera_take(struct iso_libcamera_pair *pair, int camera,
                       struct iso_libcamera_picture *out)
{
    return module()->take(pair, camera, out);
}

int iso_libcamera_give_back(struct iso_libcamera_pair *pair, int camera)
{
    return module()->give_back(pair, camera);
}

int iso_libcamera_fd(const struct iso_libcamera_pair *pair, int camera)
{
    return module()->fd(pair, camera);
}
