//! What a recording holds, in a page.
