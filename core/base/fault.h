/* One line that names a thing and what is wrong with it, for people: filled in by functions that
 * read what comes from outside (files, configuration, devices), beside their negative errno. */
#ifndef ISO_CORE_BASE_FAULT_H
#define ISO_CORE_BASE_FAULT_H

struct iso_fault {
    char text[256]; /* no newline; "" if nothing was said */
};

/* Writes the text (cut to fit) if fault is not NULL, and returns `error` (a negative errno) so that
 * a caller can `return iso_fault_set(fault, -EBADMSG, "%s: truncated", path);`. */
int iso_fault_set(struct iso_fault *fault, int error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
