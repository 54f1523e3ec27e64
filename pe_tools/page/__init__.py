"""The review page: one HTML file that shows a rig, its score and what its sensors see. It is the
same from Blender and from a command line. `sections` lists its parts, `document` puts them
together."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from .build import review_studies, write_front_page, write_search_page
    from .document import PAGE, page_bytes, write_page
    from .pictures.vehicle_picture import picture_file, vehicle_picture
    from .report_context import About, ReportContext, keyed_contexts
    from .verification import verification_page
