"""The commands of `stickslip`, one module each: options in, tables out."""
