/* The state of the service on the bus. Internal to firmware/bus. */
#ifndef ISO_FIRMWARE_BUS_BUS_STATE_H
#define ISO_FIRMWARE_BUS_BUS_STATE_H

#include <systemd/sd-bus.h>

#include "firmware/bus/bus.h"
#include "firmware/bus/call_rate.h"
#include "firmware/contract/work_listener.h"
#include "firmware/stream/head_outline.h"
#include "firmware/stream/stream_list.h"

/* The relief of a frame while it is sent; else all zero. */
struct iso__bus_relief {
    struct iso_relief_record record;
    uint8_t bytes[ISO_STREAM_BYTES_MAX];
};

/* The login that goes on, and the user of the last VerifySelf. */
struct iso__bus_login {
    bool on;         /* the claim of this client is for a login alone */
    bool self;       /* ... that VerifySelf began */
    uid_t last_user; /* of the last VerifySelf */
    int64_t rest_ns; /* before this time that user begins no other */
};

struct iso_bus {
    char address[256];
    sd_event *event; /* the event loop of iso_bus_serve */
    sd_bus *bus;     /* NULL: the connection is gone */
    sd_bus_slot *object, *disconnected, *filter, *naming;
    sd_bus_track *track; /* tracks the claimant */
    char claimant[256];  /* unique name; "": no client */
    struct iso__bus_login login;
    sd_bus_track *aiming;           /* clients that get View signals; NULL: none */
    sd_bus_message *picture;        /* the call of Picture that has no answer yet; NULL: none */
    struct iso_stream_list streams; /* of the clients that watch */
    struct iso_head_outline head;   /* n == 0: not prepared, or there is none */
    struct iso__bus_relief relief;
    uint32_t frames_seen; /* while somebody watched */
    bool gone, serving;   /* serving: this connection has the name */
    struct iso_call_rate rate;
    struct iso_appliance *appliance;
    const struct iso_appliance_borrowed *borrowed;
};

/* Methods and signals of the contract (bus_methods.c); the context is a struct iso_bus. */
extern const sd_bus_vtable iso__bus_vtable[];

/* Copies a text, cut to fit. D-Bus accepts UTF-8 only, but names of files may contain other bytes;
 * these become '?' (bus_status.c). */
void iso__bus_clean_text(char *to, size_t size, const char *from);

/* Appends the a{sv} of GetStatus (bus_status.c). */
int iso__bus_append_status(sd_bus_message *reply, const struct iso_bus *bus);

/* The methods that list the configuration and change it (bus_settings.c). */
int iso__bus_get_settings(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_set_setting(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_reset_setting(sd_bus_message *call, void *context, sd_bus_error *out);

/* Describes the user who makes a call, for a record: "asked by user 1000" (bus_act.c). */
void iso__bus_describe_caller(sd_bus_message *call, char *who, size_t size);

/* Appends what the people have taught the metric: entries of an a{sv} that is open; and the methods
 * about it (bus_site.c). */
int iso__bus_append_site(sd_bus_message *reply, const struct iso_bus *bus);
int iso__bus_get_site(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_list_look_alikes(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_list_other(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_reset_site(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_roll_back_site(sd_bus_message *call, void *context, sd_bus_error *out);

/* Appends the a{sv} of View, or its entries to one that is open (bus_view.c). */
int iso__bus_append_view(sd_bus_message *message, const struct iso_view *view);
int iso__bus_append_view_entries(sd_bus_message *message, const struct iso_view *view);

/* Methods that begin and end View signals (bus_view.c). */
int iso__bus_aim_start(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_aim_stop(sd_bus_message *call, void *context, sd_bus_error *out);

/* The method that asks for a picture, and the event that answers it (bus_picture.c). */
int iso__bus_picture(sd_bus_message *call, void *context, sd_bus_error *out);
void iso__bus_on_picture(void *context, const struct iso_frame *frame);

/* The methods that open a stream, the event that sends a record to those who watch, and the end of
 * all streams of the relief, which last no longer than the claim (bus_watch.c). */
int iso__bus_watch(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_watch_relief(sd_bus_message *call, void *context, sd_bus_error *out);
void iso__bus_on_seen(void *context, const struct iso_seen_frame *seen);
void iso__bus_end_relief(struct iso_bus *bus);

/* The user who makes a call, the method that puts an act of a client on record, and the record that
 * a person has consented to the enrolment that a call begins (bus_act.c). */
int iso__bus_user_of(sd_bus_message *call, uid_t *user);
int iso__bus_record_consent(struct iso_bus *bus, sd_bus_message *call, const char *person,
                            struct iso_fault *fault);
int iso__bus_record_act(sd_bus_message *call, void *context, sd_bus_error *out);

/* Whether a text has 1 to `most` bytes, all of them small letters, digits, '.', '-' and '_', so
 * that it cannot look like something else in the log (bus_act.c). */
bool iso__bus_is_word(const char *text, size_t most);

/* The method that puts the checks of a door on record (bus_commission.c). */
int iso__bus_record_commission(sd_bus_message *call, void *context, sd_bus_error *out);

/* The methods of the actions, of the status, of lock-out and lockdown, and of the log
 * (bus_methods.c). */
int iso__bus_enroll_start(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_enroll_stop(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_verify_start(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_verify_stop(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_identify_start(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_identify_stop(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_get_status(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_clear_lockout(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_set_lockdown(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_read_log(sd_bus_message *call, void *context, sd_bus_error *out);

/* The methods of the policy and of credentials (bus_access.c). */
int iso__bus_get_policy(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_set_policy(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_check_policy(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_test_access(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_get_credential(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_set_credential(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_list_credentials(sd_bus_message *call, void *context, sd_bus_error *out);

/* Returns 0 if the sender of a call has the claim, and not for a login alone. Otherwise returns a
 * negative errno and sets the error (bus_claim.c). */
int iso__bus_require_claim(const struct iso_bus *bus, sd_bus_message *call, sd_bus_error *out);

/* The same if nobody has the claim. The other two, in this order, make the caller the claimant: the
 * first begins to track it (a negative errno if it cannot), the second notes its name once the
 * appliance has given the claim. (bus_claim.c) */
int iso__bus_require_free(const struct iso_bus *bus, sd_bus_message *call, sd_bus_error *out);
int iso__bus_track_claimant(struct iso_bus *bus, sd_bus_message *call);
void iso__bus_note_claimant(struct iso_bus *bus, sd_bus_message *call);

/* The methods Claim and Release (bus_claim.c). */
int iso__bus_claim(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_release(sd_bus_message *call, void *context, sd_bus_error *out);

/* The methods that verify a person for a login, and the end of such a claim (bus_login.c). */
int iso__bus_verify_self(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_verify_login(sd_bus_message *call, void *context, sd_bus_error *out);
void iso__bus_end_login(struct iso_bus *bus);

/* The error of the contract for an errno of the appliance. A method returns the result. */
int iso__bus_refuse(sd_bus_error *out, int error, const struct iso_fault *fault);

/* A long call that is being served, and the time of the last Progress signal to its caller. */
struct iso__bus_progress {
    const struct iso_bus *bus;
    const char *caller; /* unique name, owned by the call */
    int64_t sent_ns;    /* at first the time at which the call began */
};

/* A listener that sends Progress signals to the caller, at most two a second and none in the first
 * half second. `progress` and the call must outlive it. (bus_progress.c) */
struct iso_work_listener iso__bus_report_progress(struct iso__bus_progress *progress,
                                                  const struct iso_bus *bus, sd_bus_message *call);

/* The methods of isotherm-link, and the event that something waits for it (bus_fleet.c). */
int iso__bus_get_fleet(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_join(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_leave(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_question(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_receive(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_fetch(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_snapshot(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_events(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_requests(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_update(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_fleet_fetch_update(sd_bus_message *call, void *context, sd_bus_error *out);
void iso__bus_on_fleet_work(void *context, const char *what);

/* The methods of an administrator (bus_admin.c). */
int iso__bus_export(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_import(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_rotate_keys(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_get_address(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_test_door(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_install_panel(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_verify_log(sd_bus_message *call, void *context, sd_bus_error *out);

/* Sends a reply that was filled in with result r, and releases it. */
int iso__bus_send_reply(sd_bus_message *reply, int r);

/* Appends the rows of a list to a reply; a negative errno if it fails. */
typedef int (*iso__bus_append_fn)(sd_bus_message *reply, const struct iso_bus *bus);

/* Answers a call with the list that `append` writes, or with the error of a gallery that cannot be
 * read (bus_people.c). */
int iso__bus_reply_list(sd_bus_message *call, const struct iso_bus *bus, iso__bus_append_fn append,
                        sd_bus_error *out);

/* The methods that list people or change a person (bus_people.c). */
int iso__bus_list_people(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_delete_person(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_set_validity(sd_bus_message *call, void *context, sd_bus_error *out);
int iso__bus_rename(sd_bus_message *call, void *context, sd_bus_error *out);

/* Reads the value of an option, whose name was read before, if it is an option of validity. Returns
 * 1; 0 if it is another option; or a negative errno. iso__bus_refuse_option answers the last two.
 * (bus_people.c) */
int iso__bus_read_validity_option(sd_bus_message *call, const char *name,
                                  struct iso_validity_change *change);
int iso__bus_refuse_option(sd_bus_error *out, int r, const char *name);

/* Answers EnrollStart. `known` is the person who had the name before, or NULL (bus_people.c). */
int iso__bus_reply_enrolment(sd_bus_message *call, const struct iso_person *known);

/* Sends the view to the clients that want it (bus_view.c): a handler of iso_appliance_events. */
void iso__bus_on_view(void *context, const struct iso_view *view);

/* Makes a signal of the contract, to be filled in. -ENOTCONN before the service is offered, and
 * while the connection is lost. */
int iso__bus_new_signal(const struct iso_bus *bus, const char *member, sd_bus_message **out);

/* Sends a signal that was filled in with result r, to one client or (NULL) to all, and releases it.
 * A signal that cannot be sent is lost, because the appliance does not depend on it. */
void iso__bus_send_signal(sd_bus_message *signal, const char *destination, int r);

/* Forgets the client that had the claim (bus_claim.c). */
void iso__bus_forget_claimant(struct iso_bus *bus);

#endif
