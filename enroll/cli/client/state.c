#include "enroll/cli/client/state.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* Converts the value of a variant to JSON. -EBADMSG for a type that no status has. */
static int read_value(sd_bus_message *reply, char type, json_t **out)
{
    union {
        const char *text;
        int boolean;
        uint32_t u;
        int32_t i;
        uint64_t t;
        int64_t x;
        double d;
    } value;
    const int r = sd_bus_message_read_basic(reply, type, &value);

    if (r < 0) {
        return r;
    }
    switch (type) {
    case 's':
        *out = json_string(value.text);
        break;
    case 'b':
        *out = json_boolean(value.boolean);
        break;
    case 'u':
        *out = json_integer(value.u);
        break;
    case 'i':
        *out = json_integer(value.i);
        break;
    case 't':
        *out = json_integer((json_int_t)value.t);
        break;
    case 'x':
        *out = json_integer(value.x);
        break;
    case 'd':
        *out = isfinite(value.d) ? json_real(value.d) : json_null();
        break;
    default:
        return -EBADMSG;
    }
    return *out ? 0 : -ENOMEM;
}

int cli_state_read_texts(sd_bus_message *message, json_t **out)
{
    json_t *list = json_array();
    const char *text;
    int r = list ? sd_bus_message_enter_container(message, 'a', "s") : -ENOMEM;

    while (r >= 0 && (r = sd_bus_message_read_basic(message, 's', &text)) > 0) {
        r = json_array_append_new(list, json_string(text)) == 0 ? r : -ENOMEM;
    }
    if (r >= 0) {
        r = sd_bus_message_exit_container(message);
    }
    if (r < 0) {
        json_decref(list);
        return r;
    }
    *out = list;
    return 0;
}

/* Reads one {sv} whose container has been entered. */
static int read_entry(sd_bus_message *reply, json_t *state)
{
    const char *name, *type;
    json_t *value = NULL;
    char container;
    int r = sd_bus_message_read_basic(reply, 's', &name);

    if (r >= 0) {
        r = sd_bus_message_peek_type(reply, &container, &type);
    }
    if (r >= 0) {
        r = sd_bus_message_enter_container(reply, 'v', type);
    }
    if (r >= 0) {
        r = strcmp(type, "as") == 0 ? cli_state_read_texts(reply, &value)
                                    : read_value(reply, type[0], &value);
    }
    if (r >= 0) {
        r = json_object_set_new(state, name, value);
    }
    return r < 0 ? r : sd_bus_message_exit_container(reply);
}

static int read_dictionary(sd_bus_message *reply, json_t *state)
{
    int r = sd_bus_message_enter_container(reply, 'a', "{sv}");

    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        r = read_entry(reply, state);
        if (r >= 0) {
            r = sd_bus_message_exit_container(reply);
        }
    }
    return r;
}

int cli_state_read(sd_bus_message *message, json_t **out)
{
    json_t *state = json_object();
    const int r = state ? read_dictionary(message, state) : -ENOMEM;

    if (r < 0) {
        json_decref(state);
        return r;
    }
    *out = state;
    return 0;
}

const char *cli_state_text(const json_t *state, const char *name)
{
    return json_string_value(json_object_get(state, name));
}

double cli_state_real(const json_t *state, const char *name)
{
    const json_t *value = json_object_get(state, name);

    return json_is_number(value) ? json_number_value(value) : NAN;
}

json_int_t cli_state_number(const json_t *state, const char *name, json_int_t otherwise)
{
    const json_t *value = json_object_get(state, name);

    return json_is_integer(value) ? json_integer_value(value) : otherwise;
}
