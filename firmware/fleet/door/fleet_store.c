#include "firmware/fleet/door/fleet_store.h"

static int get_state(void *context, struct iso_fault *fault)
{
    return iso_gallery_state(context, fault);
}

static struct iso_gallery_version get_version(void *context)
{
    return iso_gallery_version(context);
}

static const struct iso_person *get_people(void *context, size_t *n)
{
    return iso_gallery_people(context, n);
}

static const struct iso_person *find(void *context, const char *name)
{
    return iso_gallery_find(context, name);
}

static const struct iso_person *find_id(void *context, int64_t person)
{
    return iso_gallery_find_id(context, person);
}

static const void *get_access(void *context, int64_t id, size_t *size)
{
    return iso_gallery_access(context, id, size);
}

static int stage(void *context, const void *record, size_t size, struct iso_fault *fault)
{
    return iso_gallery_stage(context, ISO_GALLERY_FLEET, record, size, fault);
}

static void unstage(void *context)
{
    iso_gallery_unstage(context);
}

static int apply(void *context, struct iso_gallery_change *changes, size_t n, const void *record,
                 size_t size, struct iso_fault *fault)
{
    int error = stage(context, record, size, fault);
    if (!error) {
        error = iso_gallery_apply(context, changes, n, fault);
    }
    unstage(context);
    return error;
}

static int get_templates(void *context, const struct iso_person *person,
                         int (*each)(void *context, const struct iso_gallery_item *item,
                                     struct iso_fault *fault),
                         void *each_context, struct iso_fault *fault)
{
    return iso_gallery_export(context, person->name, each, each_context, fault);
}

struct iso_fleet_store iso_fleet_gallery_store(struct iso_gallery *gallery)
{
    return (struct iso_fleet_store){
        .context = gallery,
        .state = get_state,
        .version = get_version,
        .people = get_people,
        .find = find,
        .find_id = find_id,
        .access = get_access,
        .apply = apply,
        .stage = stage,
        .unstage = unstage,
        .templates = get_templates,
    };
}
