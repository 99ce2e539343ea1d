/* Brings a gallery that is out of service back into service (gallery.h). */
#include "firmware/gallery/gallery_state.h"

int iso_gallery_state(const struct iso_gallery *gallery, struct iso_fault *fault)
{
    return iso_gallery_db_state(gallery->db, fault);
}

bool iso__gallery_is_lost(const struct iso_gallery *gallery)
{
    return iso_gallery_db_state(gallery->db, NULL) != 0;
}

int iso_gallery_recover(struct iso_gallery *gallery, struct iso_fault *fault)
{
    struct iso_gallery_memory now = {0};
    struct iso_fault why = {.text = ""};
    if (!iso__gallery_is_lost(gallery)) {
        return 0;
    }
    const int error = iso_gallery_db_recover(gallery->db, fault);
    if (error) {
        return error;
    }
    if (iso_gallery_memory_load(gallery->db, gallery->memory.algorithm, gallery->memory.metric,
                                gallery->memory.adapt, NULL, &now, &why)) {
        return iso_gallery_db_give_up(gallery->db, &why, fault);
    }
    iso_gallery_memory_set_sensor(&now, gallery->memory.sensor);
    iso_gallery_memory_done(&gallery->memory);
    gallery->memory = now;
    return 0;
}
