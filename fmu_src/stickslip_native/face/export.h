/* Macros of the FMI functions: they and no other function are exported from the library. */
#ifndef STICKSLIP_EXPORT_H
#define STICKSLIP_EXPORT_H

#if defined _WIN32 || defined __CYGWIN__
#define STICKSLIP_EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define STICKSLIP_EXPORT __attribute__((visibility("default")))
#else
#define STICKSLIP_EXPORT
#endif

/* Behind a parameter that is there because FMI has it. */
#if defined __GNUC__
#define IGNORED __attribute__((unused))
#else
#define IGNORED
#endif

/* A name behind a prefix that is a macro itself. */
#define STICKSLIP_PASTE(prefix, name) prefix##name
#define STICKSLIP_PREFIXED(prefix, name) STICKSLIP_PASTE(prefix, name)

#endif
