/* What the service on the bus holds. Internal to firmware/bus. */
#ifndef ISO_FIRMWARE_BUS_BUS_STATE_H
#define ISO_FIRMWARE_BUS_BUS_STATE_H

#include <systemd/sd-bus.h>

#include "firmware/bus/bus.h"
#include "firmware/bus/call_rate.h"
#include "firmware/contract/work_listener.h"

struct iso_bus {
    char address[256];
    sd_event *event; /* that of iso_bus_serve */
    sd_bus *bus;     /* NULL: it is gone */
    sd_bus_slot *object, *disconnected, *filter, *naming;
    sd_bus_track *track;     /* of the claimant */
    char claimant[256];      /* unique name; "": nobody */
    sd_bus_track *aiming;    /* who wants View signals; NULL: nobody */
    sd_bus_message *picture; /* the call of Picture that has still to be answered; NULL: none */
    bool gone, serving;      /* serving: the name is ours */
    struct iso_call_rate rate;
    struct iso_appliance *appliance;
    const struct iso_appliance_borrowed *borrowed;
};

/* Methods and signals of the contract (bus_methods.c); the context is a struct iso_bus. */
extern const sd_bus_vtable iso__bus_vtable[];

/* Copies a text, cut to fit; D-Bus carries UTF-8 only, which names of files need not be: other
 * bytes become '?' (bus_status.c). */
void iso__bus_clean_text(char *to, size_t size, const char *from);

/* Appends the a{sv} of GetStatus (bus_status.c). */
int iso__bus_append_status(sd_bus_message *reply, const struct iso_bus *bus);

/* Appends the a{sv} of View, or into one that is open its entries (bus_view.c). */
int iso__bus_append_view(sd_bus_message *message, const struct iso_view *view);
int iso__bus_append_view_entries(sd_bus_message *message, const struct iso_view *view);

/* Methods that begin and end View signals (bus_view.c). */
int iso__bus_aim_start(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_aim_stop(sd_bus_message *call, void *context, sd_bus_error *out);

/* The method that asks for a picture, and the event that answers it (bus_picture.c). */
int iso__bus_picture(sd_bus_message *call, void *context, sd_bus_error *out);
void iso__bus_on_picture(void *context, const struct iso_frame *frame);

/* Whether the sender of a call has the claim; if not, a negative errno, and the error says so
 * (bus_methods.c). */
int iso__bus_require_claim(const struct iso_bus *bus, sd_bus_message *call, sd_bus_error *out);

/* The error of the contract for an errno of the appliance; what a method returns then. */
int iso__bus_refuse(sd_bus_error *out, int error, const struct iso_fault *fault);

/* A long call that is being served, and when its caller was told last how far it is. */
struct iso__bus_progress {
    const struct iso_bus *bus;
    const char *caller; /* unique name, in the call */
    int64_t sent_ns;    /* at first: when the call began */
};

/* A listener that sends Progress signals to the caller, at most two a second and none in the first
 * half second. `progress` and the call have to outlive it. (bus_progress.c) */
struct iso_work_listener iso__bus_report_progress(struct iso__bus_progress *progress,
                                                  const struct iso_bus *bus, sd_bus_message *call);

/* The methods of an administrator (bus_admin.c). */
int iso__bus_export(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_import(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_rotate_keys(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_get_address(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_test_door(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_verify_log(sd_bus_message *call, void *context, sd_bus_error *out);

/* Sends a reply that was filled in with result r, and gives it up. */
int iso__bus_send_reply(sd_bus_message *reply, int r);

/* The methods that list people or change a person (bus_people.c). */
int iso__bus_list_people(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_delete_person(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_set_validity(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_rename(sd_bus_message *call, void *context, sd_bus_error *out);

/* Reads the value of an option, whose name was read, if it is one of validity: 1; 0 if it is none,
 * or a negative errno. iso__bus_refuse_option answers the last two. (bus_people.c) */
int iso__bus_read_validity_option(sd_bus_message *call, const char *name,
                                  struct iso_validity_change *change);
int iso__bus_refuse_option(sd_bus_error *out, int r, const char *name);

/* Answers EnrollStart; `known` is who has the name before it, or NULL (bus_people.c). */
int iso__bus_reply_enrolment(sd_bus_message *call, const struct iso_person *known);

/* Sends what is seen to who wants it (bus_view.c): a handler of iso_appliance_events. */
void iso__bus_on_view(void *context, const struct iso_view *view);

/* A signal of the contract, to be filled in. -ENOTCONN before the service is offered. */
int iso__bus_new_signal(const struct iso_bus *bus, const char *member, sd_bus_message **out);

/* Sends a signal that was filled in with result r, to one client or (NULL) to all, and gives it up.
 * One that cannot be sent is lost: the appliance does not depend on being heard. */
void iso__bus_send_signal(sd_bus_message *signal, const char *destination, int r);

/* Nobody has the claim any more. */
void iso__bus_forget_claimant(struct iso_bus *bus);

#endif
