/* An update that comes by the pages: a bundle of RAUC, written to a folder as it comes. The web
 * server does not install it, and has no right to: once the file has its name, a unit of the image
 * (board/image/units/isotherm-update@.path) installs and removes it. The folders, which the image
 * makes:
 *
 *   DIR/page/            of the web server
 *     bundle.part        is being received
 *     bundle.raucb       is complete; the unit installs it
 *     restart            asks for a restart into the update (isotherm-restart@.path)
 *   DIR/page.raucb       of root: the bundle that is being installed
 *   DIR/result.json      of root: what became of the last update (install-update)
 *
 * One bundle at a time. Nothing is synchronised to the disk: after a power cut the image empties
 * the folder. */
#ifndef WEB_UPDATE_UPLOAD_H
#define WEB_UPDATE_UPLOAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WEB_UPLOAD_MOST_BYTES (UINT64_C(512) << 20)

struct web_upload {
    const char *folder; /* DIR; the caller keeps it */
    int fd;             /* of bundle.part; -1: no bundle comes */
    uint64_t size, received;
    const void *owner; /* who sends the bundle, to tell it from others; never looked into */
};

/* Makes an upload that has not begun. */
void web_upload_init(struct web_upload *upload, const char *folder);

/* Whether the machine takes updates like this: DIR/page is a folder. */
bool web_upload_is_possible(const struct web_upload *upload);

/* Whether a bundle comes; and whether one is complete and the unit has not done with it. */
bool web_upload_is_coming(const struct web_upload *upload);
bool web_upload_is_handed_over(const struct web_upload *upload);

/* The bytes that a bundle may have now: at most WEB_UPLOAD_MOST_BYTES, and not more than
 * iso_disk_room(). */
uint64_t web_upload_room(const struct web_upload *upload);

/* Begins a bundle of `size` bytes. 0; -ENOENT: not possible; -EBUSY: another bundle comes or was
 * handed over; -ENOSPC: too large for the disk; or the error of the file. */
int web_upload_begin(struct web_upload *upload, const void *owner, uint64_t size)
    __attribute__((warn_unused_result));

/* Adds bytes. 0; -EMSGSIZE: more than were announced; or the error of the file, such as -ENOSPC.
 * After an error the caller drops the upload. */
int web_upload_take(struct web_upload *upload, const void *bytes, size_t size)
    __attribute__((warn_unused_result));

/* Whether all bytes have come. */
bool web_upload_is_complete(const struct web_upload *upload);

/* Gives the bundle to the unit; without an error the upload has ended. */
int web_upload_hand_over(struct web_upload *upload) __attribute__((warn_unused_result));

/* Removes what has come, if it is of this owner. */
void web_upload_drop(struct web_upload *upload, const void *owner);

/* Leaves the wish for a restart. 0, or the error of the file. */
int web_upload_wish_restart(const struct web_upload *upload) __attribute__((warn_unused_result));

#endif
