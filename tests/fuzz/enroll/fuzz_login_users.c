/* The file of the users for logins: it is refused with a line, or the person that it names could be
 * one. The name of the user is the first line of the input. */
#include <stdlib.h>
#include <string.h>

#include "drivers/base/utf8.h"
#include "firmware/contract/login_users.h"
#include "tests/fuzz/fuzz.h"

/* Whether a line of the file begins with the user and a blank, and goes on with the person. */
static bool has_line(const char *text, const char *user, const char *person)
{
    const size_t user_length = strlen(user), person_length = strlen(person);
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, user, user_length) == 0 && line[user_length] == ' ' &&
            strncmp(line + user_length + 1, person, person_length) == 0) {
            return true;
        }
    }
    return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *end = size ? memchr(data, '\n', size) : NULL;
    const size_t user_size = end ? (size_t)(end - data) : 0;
    const size_t text_size = end ? size - user_size - 1 : size;
    char person[ISO_PERSON_NAME_SIZE] = "untouched";
    struct iso_fault fault = {0};
    char *user = strndup((const char *)data, user_size);
    char *text = malloc(text_size + 1), *before = malloc(text_size + 1);
    fuzz_check(user && text && before, "memory");
    memcpy(text, data + size - text_size, text_size);
    text[text_size] = '\0';
    memcpy(before, text, text_size + 1);
    const int error = iso_login_users_parse("users", text, text_size, user, person, &fault);
    if (error == 0) {
        fuzz_check(*person && iso_utf8_is_valid(person), "a person with a name");
        fuzz_check(has_line(before, user, person), "the line of this user");
    } else {
        fuzz_check(strcmp(person, "untouched") == 0, "no person after a fault");
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    free(before);
    free(text);
    free(user);
    return 0;
}
