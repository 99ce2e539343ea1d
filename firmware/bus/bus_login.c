/* The methods VerifySelf and VerifyLogin: a person is verified for a login of this machine.
 *
 * VerifySelf is the one method that every local user may call. So it says as little as possible: a
 * verdict without a name and a score, about the person who belongs to the calling user. It keeps
 * the camera for one look of limited time, and then the others have their turn. */
#include <errno.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/file/file.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/login_users.h"

/* How long the same user waits after a login of VerifySelf: others who wait get the camera. */
#define SELF_REST_NS (2000 * ISO_NS_PER_MS)

enum { PASSWD_MAX_BYTES = 16 << 20, ROW_BYTES = 4096 };

static int64_t now_ns(const struct iso_bus *bus)
{
    return iso_times_now_ns(&bus->borrowed->times);
}

void iso__bus_end_login(struct iso_bus *bus)
{
    if (bus->login.on && bus->login.self) {
        bus->login.rest_ns = now_ns(bus) + SELF_REST_NS;
    }
    bus->login.on = false;
}

/* ---- which person the caller is ---- */

/* Finds the name of a Unix user in /etc/passwd. The daemon may neither load modules nor ask other
 * services, so it does not use the name service switch (nsswitch.conf): it knows local users only.
 */
static int name_of_user(uid_t user, char name[ISO_LOGIN_USER_BYTES + 1], struct iso_fault *fault)
{
    FILE *stream = NULL;
    struct passwd row, *found = NULL;
    char bytes[ROW_BYTES];
    int error = iso_file_stream("/etc/passwd", PASSWD_MAX_BYTES, &stream, fault);
    if (error) {
        return error;
    }
    do {
        error = fgetpwent_r(stream, &row, bytes, sizeof bytes, &found);
    } while (!error && found && found->pw_uid != user);
    (void)fclose(stream);
    if (error || !found || strlen(found->pw_name) > ISO_LOGIN_USER_BYTES) {
        return iso_fault_set(fault, -ESRCH, "/etc/passwd: user %u is not there", (unsigned)user);
    }
    (void)snprintf(name, ISO_LOGIN_USER_BYTES + 1, "%s", found->pw_name);
    return 0;
}

/* The caller does not learn what is wrong with the file; the administrator reads it in the log. */
static int find_person(const struct iso_bus *bus, uid_t user, char person[ISO_PERSON_NAME_SIZE],
                       sd_bus_error *out)
{
    const struct iso_appliance_events *events = &bus->borrowed->events;
    struct iso_fault fault = {.text = ""};
    char name[ISO_LOGIN_USER_BYTES + 1];
    int error = name_of_user(user, name, &fault);
    if (!error) {
        error = iso_login_users_find(bus->borrowed->config->login.users, 0, name, person, &fault);
    }
    if (error == -ESRCH) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_NO_SUCH_PERSON,
                                "no person belongs to this user");
    }
    if (error) {
        events->message(events->context, LOG_WARNING, fault.text);
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_NO_LOGINS,
                                "the file of the users cannot be used");
    }
    return 0;
}

/* ---- the login ---- */

static int require_desk(const struct iso_bus *bus, sd_bus_error *out)
{
    return bus->borrowed->config->login.desk
               ? 0
               : sd_bus_error_set(out, ISO_CONTRACT_ERROR_NO_LOGINS,
                                  "this appliance guards a door and serves no logins "
                                  "([login] desk)");
}

static int begin(struct iso_bus *bus, const char *person, uid_t user, struct iso_fault *fault)
{
    char note[64];
    (void)snprintf(note, sizeof note, "login, asked by user %u", (unsigned)user);
    const int error = iso_appliance_record_act(bus->appliance, person, note, fault);
    return error ? error : iso_appliance_verify_login(bus->appliance, person, fault);
}

/* Begins the login, with its caller as the claimant. Nothing of it is left after an error. */
static int start(struct iso_bus *bus, sd_bus_message *call, const char *person, uid_t user,
                 sd_bus_error *out)
{
    struct iso_fault fault = {.text = ""};
    const char *flaw = iso_person_name_flaw(person);
    if (flaw) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_INVALID_NAME, flaw);
    }
    int r = iso__bus_track_claimant(bus, call);
    if (r < 0) {
        return r;
    }
    r = begin(bus, person, user, &fault);
    if (r < 0) {
        bus->track = sd_bus_track_unref(bus->track);
        return iso__bus_refuse(out, r, &fault);
    }
    iso__bus_note_claimant(bus, call);
    bus->login.on = true;
    return 0;
}

/* A user who has just had the camera waits, and so does one who asks without end. */
static int take_turn(struct iso_bus *bus, uid_t user, sd_bus_error *out)
{
    const int64_t now = now_ns(bus);
    if (user == bus->login.last_user && now < bus->login.rest_ns) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_ALREADY_IN_USE,
                                "this user has just had the camera: wait two seconds");
    }
    bus->login.last_user = user;
    bus->login.rest_ns = now + SELF_REST_NS;
    return 0;
}

int iso__bus_verify_self(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    char person[ISO_PERSON_NAME_SIZE];
    uid_t user = 0;
    int r = require_desk(bus, out);
    if (r >= 0) {
        r = iso__bus_require_free(bus, call, out);
    }
    if (r >= 0) {
        r = iso__bus_user_of(call, &user);
    }
    if (r >= 0) {
        r = take_turn(bus, user, out);
    }
    if (r >= 0) {
        r = find_person(bus, user, person, out);
    }
    if (r >= 0) {
        r = start(bus, call, person, user, out);
    }
    if (r < 0) {
        return r;
    }
    bus->login.self = true;
    return sd_bus_reply_method_return(call, "u", (uint32_t)user);
}

int iso__bus_verify_login(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    const char *person = NULL;
    uid_t user = 0;
    int r = sd_bus_message_read(call, "s", &person);
    if (r >= 0) {
        r = iso__bus_user_of(call, &user);
    }
    if (r >= 0 && user != 0) {
        r = sd_bus_error_set(out, SD_BUS_ERROR_ACCESS_DENIED,
                             "only root may say which person logs in");
    }
    if (r >= 0) {
        r = require_desk(bus, out);
    }
    if (r >= 0) {
        r = iso__bus_require_free(bus, call, out);
    }
    if (r >= 0) {
        r = start(bus, call, person, user, out);
    }
    if (r < 0) {
        return r;
    }
    bus->login.self = false;
    return sd_bus_reply_method_return(call, NULL);
}
